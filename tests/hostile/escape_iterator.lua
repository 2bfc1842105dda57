-- expect: SCRIPT:7: bad argument #1 to 'f' (table expected, got number)
-- the iterator of pairs is called with a value that is not a table
for _, of in ipairs{{}, {1, 2, 3}, {a = 1}, {1, b = 2}} do
  local f = pairs(of)
  for _, wrong in ipairs{0, 42, 'text', print, true, io.stdout} do assert(not pcall(f, wrong)) end
  assert(not pcall(f))
  if next(of) == 'a' then f(42) end
end
