"""Gaps of surfaces at the initial pose, and bodies moved to close them."""
