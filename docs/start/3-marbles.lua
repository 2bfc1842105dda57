local things = require 'things'

gr.render{node = things.all, width = 640, height = 400}
