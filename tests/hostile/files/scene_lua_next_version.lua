local x <global> = 1
