"""A reduced body: what it holds, its file, its checks, and what is read from it."""
