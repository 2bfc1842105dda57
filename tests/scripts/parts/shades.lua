function shade(x) return x * x end
