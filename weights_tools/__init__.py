"""The PyTorch twin of orb360's networks: builds them, writes them to files, dumps references."""
