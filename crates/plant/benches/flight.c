/* The yardstick of simulation.rs: the rig without effects as straight-line C, written once more from the equations.
 *
 *   dy/dt = v      dv/dt = gain*(duty - hover) - drag*v      RK4 in steps of 1 ms at most
 *   after each step:   v += sqrt(psd*dt)*n     a reading a period: y + sensor*n
 *   at an end of the pipe the ball rests, without bounce
 *
 * The numbers of chance are those of the crate: PCG64 (XSL-RR) and Box-Muller, seeded alike, so that the two fly the same flight.
 * With noise 0 none are drawn.
 *
 *   flight time N gain drag hover length sensor psd seed       seconds that N flights took, and a sum that keeps them from being optimised away
 *   flight print 1 gain drag hover length sensor psd seed      the readings of one flight, one a line
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef unsigned __int128 u128;

enum { CYCLES = 3000 };
static const double PERIOD_S = 0.02, MAX_STEP_S = 0.001;

struct pcg64 {
    u128 state, increment;
};

static const u128 MULTIPLIER = ((u128)0x2360ed051fc65da4ULL << 64) | 0x4385df649fccf645ULL;

static inline uint64_t pcg64_next(struct pcg64 *g)
{
    g->state = g->state * MULTIPLIER + g->increment;
    unsigned rotate = (unsigned)(g->state >> 122);
    uint64_t x = (uint64_t)(g->state >> 64) ^ (uint64_t)g->state;
    return (x >> rotate) | (x << (-rotate & 63));
}

/* 32 bytes of seed from a PCG32, as rand_core expands a number. */
static struct pcg64 pcg64_seed(uint64_t seed)
{
    uint64_t word[4] = {0, 0, 0, 0};
    for (int i = 0; i < 8; i++) {
        seed = seed * 6364136223846793005ULL + 11634580027462260723ULL;
        uint32_t x = (uint32_t)(((seed >> 18) ^ seed) >> 27);
        unsigned rotate = (unsigned)(seed >> 59);
        uint64_t out = (x >> rotate) | (x << (-rotate & 31));
        word[i / 2] |= out << (32 * (i % 2));
    }
    struct pcg64 g = {((u128)word[1] << 64) | word[0], (((u128)word[3] << 64) | word[2]) | 1};
    g.state += g.increment;
    g.state = g.state * MULTIPLIER + g.increment;
    return g;
}

struct normal {
    struct pcg64 generator;
    double second;
    int has_second;
};

static struct normal normal_stream(uint64_t seed, int stream)
{
    struct pcg64 seeder = pcg64_seed(seed);
    uint64_t key = pcg64_next(&seeder);
    for (int i = 0; i < stream; i++)
        key = pcg64_next(&seeder);
    struct normal n = {pcg64_seed(key), 0.0, 0};
    return n;
}

static inline double uniform(struct normal *n)
{
    return (double)(pcg64_next(&n->generator) >> 11) * 0x1p-53;
}

static inline double draw(struct normal *n)
{
    if (n->has_second) {
        n->has_second = 0;
        return n->second;
    }
    double radius = sqrt(-2.0 * log(1.0 - uniform(n)));
    double angle = 6.283185307179586476925 * uniform(n);
    n->second = radius * sin(angle);
    n->has_second = 1;
    return radius * cos(angle);
}

struct rig {
    double gain, drag, hover, length, sensor, psd;
    uint64_t seed;
};

struct ball {
    double y, v;
};

static inline struct ball rk4(struct ball b, double force, double drag, double dt)
{
    double h = dt / 2.0;
    double y1 = b.v, v1 = force - drag * b.v;
    double y2 = b.v + h * v1, v2 = force - drag * y2;
    double y3 = b.v + h * v2, v3 = force - drag * y3;
    double y4 = b.v + dt * v3, v4 = force - drag * y4;
    struct ball end = {b.y + dt / 6.0 * (y1 + 2.0 * y2 + 2.0 * y3 + y4), b.v + dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)};
    return end;
}

/* A step that may begin or end at an end of the pipe: the ball rests there, or leaves it. */
static struct ball at_end(struct ball b, double force, double drag, double length, double dt)
{
    double out = b.y <= 0.0 ? -1.0 : b.y >= length ? 1.0 : 0.0;
    if (b.v * out > 0.0)
        b.v = 0.0;
    struct ball end = rk4(b, force, drag, dt);
    if (end.y >= 0.0 && end.y <= length)
        return end;
    end.y = end.y < 0.0 ? 0.0 : length;
    end.v = 0.0;
    return end;
}

/* One flight of 60 s: PD control of the readings, as simulation.rs does it. */
static double fly(const struct rig *rig, double *readings)
{
    struct normal process = normal_stream(rig->seed, 0), sensor = normal_stream(rig->seed, 1);
    struct ball b = {0.0, 0.0};
    double last = 0.0, sum = 0.0;
    for (int cycle = 0; cycle < CYCLES; cycle++) {
        double reading = b.y + (rig->sensor > 0.0 ? rig->sensor * draw(&sensor) : 0.0);
        readings[cycle] = reading;
        sum += reading;
        double setpoint = cycle % 800 < 400 ? 400.0 : 200.0;
        double duty = rig->hover + 0.018 * (setpoint - reading) - 0.3 * (reading - last);
        duty = fmin(fmax(duty, 10.0), 40.0);
        last = reading;
        double force = rig->gain * (duty - rig->hover);
        double ahead = PERIOD_S * (cycle + 1) - PERIOD_S * cycle;
        int steps = (int)ceil(ahead / MAX_STEP_S);
        double dt = ahead / steps;
        double white = sqrt(rig->psd * dt);
        for (int step = 0; step < steps; step++) {
            struct ball end = rk4(b, force, rig->drag, dt);
            if (b.y > 0.0 && b.y < rig->length && end.y >= 0.0 && end.y <= rig->length)
                b = end;
            else
                b = at_end(b, force, rig->drag, rig->length, dt);
            if (white > 0.0)
                b.v += white * draw(&process);
        }
    }
    return sum;
}

int main(int argc, char **argv)
{
    if (argc != 10) {
        fprintf(stderr, "flight time|print N gain drag hover length sensor psd seed\n");
        return 2;
    }
    long flights = atol(argv[2]);
    struct rig rig = {atof(argv[3]), atof(argv[4]), atof(argv[5]), atof(argv[6]), atof(argv[7]), atof(argv[8]),
                      strtoull(argv[9], NULL, 10)};
    static double readings[CYCLES];
    struct timespec start, end;
    double sum = fly(&rig, readings);
    clock_gettime(CLOCK_MONOTONIC, &start);
    for (long k = 0; k < flights; k++) {
        sum += fly(&rig, readings);
        rig.seed++;
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    if (strcmp(argv[1], "print") == 0) {
        for (int cycle = 0; cycle < CYCLES; cycle++)
            printf("%.17g\n", readings[cycle]);
        return 0;
    }
    printf("%.9f %.17g\n", (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec), sum);
    return 0;
}
