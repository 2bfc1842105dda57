-- expect: *used up its 0.1 s
local function grow(depth)
    if depth == 0 then return end
    for _ = 1, 500 do coroutine.wrap(grow)(depth - 1) end
end
grow(9)
