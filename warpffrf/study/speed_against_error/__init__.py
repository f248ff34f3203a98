"""One scene run with many settings beside a reference: what each costs, and how wrong it is; `study.speed_error`.

choices    settings: what may be chosen, which combinations are run
machines   where scenes come from: a Scene, a function that builds one, a scene file; settings applied to them; what
           times were taken on
errors     measures of two results: at the saved times that all steps have in common, of motions of points, of
           pressure on common points
folder     what is kept of a study, so that it can go on
runs       a run and what it costs
front      Pareto fronts, orders in the step
picture    error against time, error against step
outcome    what a study returns: fronts, the setting for a wanted error, tables, everything as Markdown
study      the reference, the rounds: what users call
"""
