// Under AddressSanitizer, libraries stay loaded until the program ends. Mesa's driver refers to its
// tables only from its own variables. After unloading it, LeakSanitizer would report the tables as
// leaks.
extern "C" int dlclose(void* /*module*/) { return 0; }
