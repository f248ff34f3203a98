"""One scene run with many settings beside a reference: what each costs, and how wrong it is; `study.speed_error`.

choices    settings: what may be chosen, which combinations are run
machines   where scenes come from: a Scene, a function that builds one, a scene file; settings applied to them
times      the saved times that all steps have in common
places     motion of points
fields     pressure on common points
errors     measures of two results
folder     what is kept of a study, so that it can go on
machine    what times were taken on
runs       a run and what it costs
front      Pareto fronts, orders in the step
picture    error against time, error against step
tables     of all runs, of fronts, of orders in the step
report     everything as Markdown
outcome    what a study returns: fronts, the setting for a wanted error, files
study      the reference, the rounds: what users call
"""
