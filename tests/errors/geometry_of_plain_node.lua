-- expect: SCRIPT:2: gr.geometry: primitive must be a shape, not the plain node 'n' (node 'g')
gr.geometry('g', gr.node('n'))
