-- expect: SCRIPT:3: the script used up its 0.1 s of processor time (--script-time allows more)
while true do
    coroutine.resume(coroutine.create(function() while true do end end))
end
