"""How good depth completion is, beside simpler ways to do it."""
