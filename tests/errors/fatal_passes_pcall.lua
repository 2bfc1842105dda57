-- expect: SCRIPT:3: os.exit: the script reports a failure
while true do
    pcall(function() os.exit(1) end)
end
