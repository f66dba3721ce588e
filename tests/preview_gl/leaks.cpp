// What Mesa itself does not give back is not ours to find (LeakSanitizer asks for this function).
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa.so\n"; }
