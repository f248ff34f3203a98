"""One scene run with many settings and compared with a reference: cost and error of each; `study.speed_error`.

choices    settings: available choices, combinations to run
machines   scene sources: a Scene, a function that builds one, a scene file; settings applied to them; environment
           of timings
errors     measures of two results: at the saved times that all steps have in common, of motions of points, of
           pressure on common points
folder     stored data of a study, to continue it
runs       a run and its cost
front      Pareto fronts, orders in the step
picture    error against time, error against step
outcome    result of a study: fronts, the setting for a required error, tables, Markdown report
study      public function: the reference, the rounds
"""
