"""What makes the results that the documentation shows: each experiment writes ``results/<name>.csv`` and ``.json``."""
