"""Studies of speed against error of known machines: `python -m studies.speed_error_pages [FOLDER] [--study NAME]`.

Each study runs a machine through a grid of settings beside a reference that it computes; every figure, table and
picture of its page is of the runs made then. A study is one file here, with a `Study` and a line in `STUDIES`. A page,
FOLDER/speed_error/NAME.md, is made by itself, and the index FOLDER/speed_error.md of those that are there.

    study          what a study of these is
    reduced        bodies that several studies use
    page           the page of a study, and the index of all
"""

from __future__ import annotations

from studies.speed_error_pages.bearing import BEARING
from studies.speed_error_pages.colliding_bars import COLLIDING_BARS
from studies.speed_error_pages.local_treatments import LOCAL_TREATMENTS
from studies.speed_error_pages.pressed_rollers import PRESSED_ROLLERS
from studies.speed_error_pages.rolling_cells import ROLLING_CELLS
from studies.speed_error_pages.rolling_friction import ROLLING_FRICTION
from studies.speed_error_pages.slider_crank import SLIDER_CRANK
from studies.speed_error_pages.study import Study
from studies.speed_error_pages.two_rollers import TWO_ROLLERS

STUDIES: dict[str, Study] = {
    study.name: study
    for study in (
        TWO_ROLLERS,
        PRESSED_ROLLERS,
        ROLLING_CELLS,
        LOCAL_TREATMENTS,
        COLLIDING_BARS,
        SLIDER_CRANK,
        BEARING,
        ROLLING_FRICTION,
    )
}
