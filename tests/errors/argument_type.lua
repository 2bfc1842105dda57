-- expect: SCRIPT:2: gr.light: colour must be a colour {r, g, b}, not a string; red is {1, 0, 0} or '#ff0000'
gr.light({0, 0, 0}, 'white', {1, 0, 0})
