gr.render{node = gr.sphere{}}
