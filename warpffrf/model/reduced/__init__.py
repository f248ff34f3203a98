"""A reduced body: its data, its file, its checks, and its evaluation."""
