"""What pairs that load one surface do to each other there, through its local modes."""
