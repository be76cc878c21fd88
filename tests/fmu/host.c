/* Steps the library of an FMU as a tool that simulates does: `host LIBRARY URI-OF-THE-RESOURCES`. Written against the text of the FMI
   standard 2.0, and compiled for Linux and for Windows: both print the same lines, or the platforms differ. A line is a step: position,
   whether it is new, true position and velocity; doubles by their bits, since two C libraries print decimals in two ways. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef _WIN32
#include <windows.h>
#define OPEN(path) ((void *)LoadLibraryA(path))
#define FIND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define WHY() (fprintf(stderr, "error %lu\n", (unsigned long)GetLastError()))
#else
#include <dlfcn.h>
#define OPEN(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FIND(library, name) dlsym(library, name)
#define WHY() (fprintf(stderr, "%s\n", dlerror()))
#endif

typedef void *Component;
typedef unsigned int Reference;
typedef int Status;
typedef struct {
    void (*logger)(void *, const char *, Status, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, Status);
    void *environment;
} Callbacks;

/* Variables of the description, by their references. */
enum { DUTY = 0, POSITION = 2, BALL = 3, VELOCITY = 4, FRESH = 8, SEED = 9 };
#define STEPS 400
#define PERIOD_S 0.02

static void *library;

static void *find(const char *name) {
    void *found = FIND(library, name);
    if (!found) {
        fprintf(stderr, "host: the library has no %s\n", name);
        exit(1);
    }
    return found;
}

static void say(void *environment, const char *instance, Status status, const char *category, const char *text, ...) {
    (void)environment, (void)category;
    va_list rest;
    va_start(rest, text);
    fprintf(stderr, "host: %s, status %d: ", instance, status);
    vfprintf(stderr, text, rest);
    fputc('\n', stderr);
    va_end(rest);
}

static void expect(const char *name, Status status) {
    if (status != 0) {
        fprintf(stderr, "host: %s returned %d\n", name, status);
        exit(1);
    }
}

#define CALL(name, types, ...) expect(#name, ((Status(*) types)find(#name))(__VA_ARGS__))

static void begin(Component one, int seed) {
    Reference reference = SEED;
    CALL(fmi2SetupExperiment, (Component, int, double, double, int, double), one, 0, 0.0, 0.0, 0, 0.0);
    CALL(fmi2EnterInitializationMode, (Component), one);
    CALL(fmi2SetInteger, (Component, const Reference *, size_t, const int *), one, &reference, 1, &seed);
    CALL(fmi2ExitInitializationMode, (Component), one);
}

static void print(double number) {
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    printf("%08x%08x ", (unsigned)(bits >> 32), (unsigned)bits);
}

/* The fan holds the ball for a second, and then drives it to an end and back. */
static void step(Component one, int at) {
    Reference duty = DUTY, fresh = FRESH, numbers[] = {POSITION, BALL, VELOCITY};
    double percent = at < 50 ? 43.0 : (at / 100 % 2 ? 36.0 : 52.0), values[3];
    int is_fresh;
    CALL(fmi2GetReal, (Component, const Reference *, size_t, double *), one, numbers, 3, values);
    CALL(fmi2GetBoolean, (Component, const Reference *, size_t, int *), one, &fresh, 1, &is_fresh);
    for (int i = 0; i < 3; i++) print(values[i]);
    printf("%d\n", is_fresh);
    CALL(fmi2SetReal, (Component, const Reference *, size_t, const double *), one, &duty, 1, &percent);
    CALL(fmi2DoStep, (Component, double, double, int), one, at * PERIOD_S, PERIOD_S, 1);
}

int main(int count, char **words) {
    if (count != 3) {
        fprintf(stderr, "usage: host LIBRARY URI-OF-THE-RESOURCES\n");
        return 2;
    }
    library = OPEN(words[1]);
    if (!library) {
        fprintf(stderr, "host: cannot load %s: ", words[1]);
        WHY();
        return 1;
    }
    const Callbacks callbacks = {say, calloc, free, NULL, NULL};
    Component (*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) =
        (Component(*)(const char *, int, const char *, const char *, const Callbacks *, int, int))find("fmi2Instantiate");
    Component both[2];
    for (int i = 0; i < 2; i++) {
        both[i] = instantiate(i ? "second" : "first", 1, "{}", words[2], &callbacks, 0, 0);
        if (!both[i]) return 1;
        begin(both[i], 7 + i);
    }
    /* Two instances at once, then the first again. */
    for (int at = 0; at < STEPS; at++)
        for (int i = 0; i < 2; i++) step(both[i], at);
    CALL(fmi2Reset, (Component), both[0]);
    begin(both[0], 7);
    for (int at = 0; at < STEPS; at++) step(both[0], at);
    for (int i = 0; i < 2; i++) ((void (*)(Component))find("fmi2FreeInstance"))(both[i]);
    return 0;
}
