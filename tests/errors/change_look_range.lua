-- expect: SCRIPT:2: gr.change_look: value of reflect must be from 0 to 1, not 2
gr.change_look(1, 'reflect', 2)
