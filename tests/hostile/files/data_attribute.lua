local x <magic> = 1
