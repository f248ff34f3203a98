"""A table of runs: one scene at many values of its parameters, on one core or on many; `study.sweep`.

parameters   a parameter: values, a range, a distribution; samples: points of the unit cube, Latin hypercube, Sobol,
             random, for Sobol indices
design       the rows of a sweep: all combinations, a sample, or rows as given
functions    what a function does, as a word by which a changed one is told
scenes       where the scene of a row comes from: a file or a function; rows as worlds of one graph
job          what a worker does with a row, what is kept of a run, and what it answers
parcel       what is sent to workers
errand       the function that opens it there
packing      a job packed and opened again, reduced bodies by their content hash
crews        who runs rows: this process, processes of our own, anybody with the interface of concurrent.futures
cluster      who else does: dask.distributed
folder       the folder of a sweep: what it is, who writes it, runs that have ended
table        all rows in one HDF5 file, which xarray opens lazily
outcome      a sweep as users have it
sweep        `sweep`: rows go out, answers come in
"""
