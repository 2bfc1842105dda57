-- expect: SCRIPT:3: gr.superellipsoid: e must be between 0.02 and 20 (node 'a?gray: notice: all is well?[2J')
-- A name that imitates a message of the program and clears the terminal.
gr.superellipsoid{name = 'a\ngray: notice: all is well\27[2J', e = 0}
