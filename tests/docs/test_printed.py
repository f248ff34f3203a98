"""What `printed` reads on a page: all that is to be run, nothing else, in its order."""

from __future__ import annotations

from printed import commands, printed, python_blocks

PAGE = """\
# Title
    warpffrf demo                list them
Text with `warpffrf run x.toml`, and ```python in a line.
```python
import warpffrf as wf

    warpffrf is no command here
```
    make test
    warpffrf reduce a.msh --length-unit mm \\
             --interface "bore 1" -o a.h5   the second line too
```toml
x = 1
```
```py
print(2)
```
"""


def test_blocks_and_commands_in_order() -> None:
    assert [(item.is_python, item.line) for item in printed(PAGE)] == [(False, 2), (True, 4), (False, 10), (True, 15)]
    assert python_blocks(PAGE)[1] == "print(2)\n" and "is no command here" in python_blocks(PAGE)[0]
    first, second = commands(PAGE)
    assert first.words == ["warpffrf", "demo"]
    assert second.words == [
        "warpffrf", "reduce", "a.msh", "--length-unit", "mm", "--interface", "bore 1", "-o", "a.h5"
    ]  # fmt: skip
