// Neither bindings nor push constants nor options.
layout(local_size_x = 1) in;

void main() {}
