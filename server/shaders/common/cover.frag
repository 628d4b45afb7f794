// Writes no colour, only the depth.
void main() {}
