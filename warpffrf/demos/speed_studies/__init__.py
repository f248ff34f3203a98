"""Studies of speed against error of known machines: `python -m warpffrf.demos.speed_studies [FOLDER] [--study NAME]`.

Each study runs a machine through a grid of settings beside a reference that it computes; every figure, table and
picture of its page is of the runs made then. A study is one file here, with a `Study` and a line in `STUDIES`. A page,
FOLDER/speed_error/NAME.md, is made by itself, and the index FOLDER/speed_error.md of those that are there.

    study          what a study of these is
    reduced        bodies that several studies use
    page           the page of a study, and the index of all
"""

from __future__ import annotations

from warpffrf.demos.speed_studies.bearing import BEARING
from warpffrf.demos.speed_studies.colliding_bars import COLLIDING_BARS
from warpffrf.demos.speed_studies.local_treatments import LOCAL_TREATMENTS
from warpffrf.demos.speed_studies.pressed_rollers import PRESSED_ROLLERS
from warpffrf.demos.speed_studies.rolling_cells import ROLLING_CELLS
from warpffrf.demos.speed_studies.rolling_friction import ROLLING_FRICTION
from warpffrf.demos.speed_studies.slider_crank import SLIDER_CRANK
from warpffrf.demos.speed_studies.study import Study
from warpffrf.demos.speed_studies.two_rollers import TWO_ROLLERS

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
