-- expect: SCRIPT:2: gr.change_look: value has 1 number, but ks has 3
gr.change_look(1, 'ks', 0.5)
