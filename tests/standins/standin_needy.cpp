// A library that uses a function which it does not say where to find, as VirtuoseAPI does; and, where
// STANDIN_IS_COMPANION is set, the library that has it.

extern "C" {

int standin_companion_answer();

#ifdef STANDIN_IS_COMPANION
int standin_companion_answer() { return 42; }
#else
int standin_needy_ask();
int standin_needy_ask() { return standin_companion_answer(); }
#endif
}
