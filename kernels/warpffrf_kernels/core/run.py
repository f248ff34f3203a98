"""Arguments of every kernel: models of the worlds, control words, clocks and energies, and the words of the run."""

import warp as wp

from warpffrf_kernels.core.declaration import topic
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scratch import RunWords
from warpffrf_kernels.core.state import Books


@topic
class Run(Books, RunWords):
    """One model, one control word and one clock per world."""

    models: wp.array(dtype=Model)
