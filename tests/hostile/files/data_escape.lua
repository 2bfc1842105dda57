return "\300"
