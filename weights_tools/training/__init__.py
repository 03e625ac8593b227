"""From rendered drives to trained weights. Only making shards needs OpenCV, only files h5py."""
