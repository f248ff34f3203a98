"""Parameter sweeps: one scene at many values of its parameters, on one or many cores; `study.sweep`.

parameters   a parameter: values, a range, a distribution; samples: points of the unit cube, Latin hypercube, Sobol,
             random, for Sobol indices
design       the rows of a sweep: all combinations, a sample, or rows as given
functions    identification of a function by a hash of its code
scenes       source of the scene of a row: a file or a function; rows as worlds of one graph
job          work on a row by a worker, outputs of a run, and answers
payload       data sent to workers
task       the function that opens it there and runs it
packing      a job packed and opened again, reduced bodies by their content hash
executors        executors: this process, own processes, any executor with the interface of concurrent.futures
cluster      executor of dask.distributed
folder       the folder of a sweep: definition, lock, completed runs
table        all rows in one HDF5 file, which xarray opens lazily
outcome      result of a sweep
sweep        `sweep`, the public function: sends rows and collects answers
"""
