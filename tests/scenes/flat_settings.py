"""`reduce` with the fields of its grid and options objects as keywords, for helpers that pass keywords on."""

from warpffrf.offline import ContactGrid, ReductionOptions, reduce
from warpffrf.scene_file.forms import flat

reduce_flat = flat(reduce, grid=ContactGrid, options=ReductionOptions)
