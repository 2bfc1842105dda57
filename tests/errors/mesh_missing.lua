-- expect: SCRIPT:2: gr.mesh: cannot find 'nowhere.obj' (looked in ., Assets, ../Assets) (node 'cow')
gr.mesh('cow', 'nowhere.obj')
