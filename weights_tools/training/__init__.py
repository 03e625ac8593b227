"""Trains networks on rendered drives. OpenCV is needed only for shards, h5py only for files."""
