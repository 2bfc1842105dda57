-- expect: SCRIPT:2: gr.render: caustics has the fields photons and radius, not 'photon'
gr.render {node = gr.node('n'), file = 'no.png', width = 8, height = 8, eye = {0, 0, 5}, caustics = {photon = 1000}}
