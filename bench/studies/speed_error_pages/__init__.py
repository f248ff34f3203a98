"""Studies of speed against error of known machines: `python -m studies speed_error [NAME ...]`.

Each study runs a machine with a grid of settings and compares it with a reference that it computes. Every figure, table
and picture of its page is from these runs. A study is one file here, with a `Study` and a line in `STUDIES`.

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
