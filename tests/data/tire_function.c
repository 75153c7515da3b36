/* A host of latsch_tire: what it promises, and a course over a road for a comparison.
 *
 *     tire_function F.tir F.rdf SPEED HEIGHT SPIN SECONDS > course.csv
 */
#include "latsch_tire.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char said[256];

static void fail(const char *what)
{
    fprintf(stderr, "%s: %s\n", what, said);
    exit(1);
}

static void need(int holds, const char *what)
{
    if (!holds)
        fail(what);
}

static double speed, height, spin;
/* of the speed [m/s2], and of the spin */
static double gain, spin_gain;

/* A carrier that travels straight. */
static latsch_motion at(double time)
{
    latsch_motion m = {0};
    m.time = time;
    m.dis[0] = (speed + 0.5 * gain * time) * time;
    m.dis[2] = height;
    m.tramat[0][0] = m.tramat[1][1] = m.tramat[2][2] = 1.0;
    m.vel[0] = speed + gain * time;
    m.angtwc = fmod((spin + 0.5 * spin_gain * time) * time, 6.283185307179586);
    m.omegar = spin + spin_gain * time;
    return m;
}

static int call(int job, latsch_tire_state **tire, const latsch_motion *motion, latsch_forces *forces)
{
    said[0] = 0;
    return latsch_tire(job, tire, NULL, NULL, motion, forces, said, sizeof said);
}

static latsch_forces forces_at(latsch_tire_state *tire, int job, latsch_motion motion)
{
    latsch_forces forces;
    need(call(job, &tire, &motion, &forces) == 0, "an evaluation");
    return forces;
}

static int same(const latsch_forces *a, const latsch_forces *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

static latsch_tire_state *made(char **files)
{
    latsch_tire_state *tire = NULL;
    need(latsch_tire(LATSCH_INIT, &tire, files[1], files[2], NULL, NULL, said, sizeof said) == 0, "init");
    return tire;
}

/* What a host that breaks off, repeats and goes back gets is what one gets that does not. */
static void trials(char **files)
{
    const double h = 0.0025;
    gain = 4.0;
    spin_gain = 19.0;
    latsch_tire_state *plain = made(files), *told = made(files), *untold = made(files);
    latsch_forces start = forces_at(plain, LATSCH_NORMAL, at(0.0));
    forces_at(told, LATSCH_NORMAL, at(0.0));
    forces_at(untold, LATSCH_NORMAL, at(0.0));
    latsch_motion zero = at(0.0);
    need(call(LATSCH_SSTEP, &told, &zero, NULL) == 0, "sstep");
    latsch_forces last = start, before = start;
    for (int k = 1; k <= 120; k++) {
        double t = k * h;
        before = last;
        last = forces_at(plain, LATSCH_NORMAL, at(t));

        /* Newton's iterations, differences, a stage in the middle, a step that is rejected */
        latsch_motion wild = at(t);
        wild.dis[2] -= 0.004;
        wild.vel[2] = -1.0;
        forces_at(told, LATSCH_NORMAL, wild);
        forces_at(told, LATSCH_DIFF, at(t - 0.4 * h));
        forces_at(told, LATSCH_NORMAL, at(t + 3.0 * h));
        latsch_forces found = forces_at(told, LATSCH_NORMAL, at(t));
        latsch_forces again = forces_at(told, LATSCH_DIFF, at(t));
        need(same(&found, &last) && same(&again, &last), "trial steps change something");
        /* a column of a Jacobian comes last, and the step is that of its motion */
        forces_at(told, LATSCH_DIFF, wild);
        latsch_motion motion = at(t);
        need(call(LATSCH_SSTEP, &told, &motion, NULL) == 0, "sstep");
        found = forces_at(told, LATSCH_NORMAL, at(t));
        need(same(&found, &last), "a committed step has the forces that it had");

        forces_at(untold, LATSCH_NORMAL, wild);
        found = forces_at(untold, LATSCH_NORMAL, at(t));
        need(same(&found, &last), "a repeated evaluation changes something");
    }
    need(fabs(last.force[2] - start.force[2]) > 1.0, "the forces change along the way");
    need(fabs(last.force[2]) > 100.0, "there is a load");
    need(last.varinf[9] > 0.5 && last.varinf[8] == 0.0, "rubber spins with the rim, and as printed is not carried");
    /* 50 rad/s2 more for a millisecond: 50 N.m for the rubber, and a newton-metre of slip */
    latsch_motion faster = at(120 * h + 1e-3);
    latsch_forces steady = forces_at(told, LATSCH_NORMAL, faster);
    faster.omegar += 0.05;
    faster.angtwc += 0.5 * 0.05 * 1e-3;
    latsch_forces spun = forces_at(told, LATSCH_NORMAL, faster);
    need(fabs(spun.torque[1] - steady.torque[1]) < 5.0, "spinning rubber up is the host's");

    /* back by a step, and on with the same motion */
    latsch_forces back = forces_at(told, LATSCH_NORMAL, at(119 * h));
    need(same(&back, &before), "going back");
    latsch_forces on = forces_at(told, LATSCH_NORMAL, at(120 * h));
    need(same(&on, &last), "going on again");
    latsch_motion early = at(1e-3);
    need(call(LATSCH_NORMAL, &told, &early, &on) == 1 && strstr(said, "earliest"), "too far back");

    /* a new start */
    need(call(LATSCH_RESET, &told, NULL, NULL) == 0, "reset");
    latsch_forces anew = forces_at(told, LATSCH_NORMAL, at(0.0));
    need(same(&anew, &start), "reset is a new start");
    latsch_tire_state *all[] = {plain, told, untold};
    for (int i = 0; i < 3; i++)
        need(call(LATSCH_ENDSIM, &all[i], NULL, NULL) == 0 && all[i] == NULL, "endsim");
    gain = spin_gain = 0.0;
}

/* A turned carrier has turned forces. */
static void turned(char **files)
{
    latsch_tire_state *tire = made(files);
    latsch_forces straight = forces_at(tire, LATSCH_NORMAL, at(0.0));
    need(call(LATSCH_RESET, &tire, NULL, NULL) == 0, "reset");
    latsch_motion m = at(0.0);
    double angle = 0.3, c = cos(angle), s = sin(angle);
    m.tramat[0][0] = m.tramat[1][1] = c;
    m.tramat[1][0] = s;
    m.tramat[0][1] = -s;
    latsch_forces forces = forces_at(tire, LATSCH_NORMAL, m);
    double x = straight.force[0], z = straight.force[2];
    need(fabs(x) > 1.0, "something pulls along");
    need(fabs(forces.force[0] - x * c) < 1e-6 && fabs(forces.force[1] - x * s) < 1e-6, "the force is turned");
    need(fabs(forces.force[2] - z) < 1e-6 && fabs(forces.varinf[0] - x) < 1e-6, "heading and height are not");
    need(call(LATSCH_ENDSIM, &tire, NULL, NULL) == 0, "endsim");
}

static void refusals(char **files)
{
    latsch_tire_state *tire = NULL;
    latsch_motion m = at(0.0);
    latsch_forces forces;
    need(call(LATSCH_NORMAL, &tire, &m, &forces) == 1 && strstr(said, "INIT"), "no tire yet");
    need(call(LATSCH_INQUIRE, &tire, NULL, NULL) == 0, "inquire");
    need(call(LATSCH_ENDSIM, &tire, NULL, NULL) == 0, "the end of nothing");
    need(latsch_tire(LATSCH_INIT, &tire, "none.tir", NULL, NULL, NULL, said, sizeof said) == 1, "no file");
    need(tire == NULL && strstr(said, "none.tir"), "the file is named");
    need(latsch_tire(LATSCH_INIT, &tire, files[1], files[1], NULL, NULL, NULL, 0) == 1, "a road that is none, and no message");
    need(latsch_tire(LATSCH_INIT, NULL, files[1], NULL, NULL, NULL, said, sizeof said) == 1, "no place for it");
    tire = made(files);
    need(latsch_tire(LATSCH_INIT, &tire, files[1], NULL, NULL, NULL, said, sizeof said) == 1, "a second one in its place");
    need(call(7, &tire, &m, &forces) == 1 && strstr(said, "no job 7"), "a job that is none");
    need(call(LATSCH_NORMAL, &tire, NULL, &forces) == 1 && call(LATSCH_NORMAL, &tire, &m, NULL) == 1, "null pointers");
    m.vel[1] = NAN;
    need(call(LATSCH_NORMAL, &tire, &m, &forces) == 1 && strstr(said, "finite"), "a value that is none");
    m = at(0.0);
    m.tramat[2][2] = 0.5;
    need(call(LATSCH_NORMAL, &tire, &m, &forces) == 1 && strstr(said, "rotation"), "a matrix that does not turn");
    /* all of that leaves it as it was */
    forces_at(tire, LATSCH_NORMAL, at(0.0));
    need(call(LATSCH_ENDSIM, &tire, NULL, NULL) == 0, "endsim");
}

int main(int count, char **arguments)
{
    if (count != 7)
        return 2;
    speed = atof(arguments[3]);
    height = atof(arguments[4]);
    spin = atof(arguments[5]);
    refusals(arguments);
    trials(arguments);
    turned(arguments);
    latsch_tire_state *tire = made(arguments);
    puts("time [s],force_x [N],force_z [N],moment_y [N.m]");
    int steps = (int)(1e3 * atof(arguments[6]) + 0.5);
    for (int k = 0; k <= steps; k++) {
        latsch_forces forces = forces_at(tire, LATSCH_NORMAL, at(1e-3 * k));
        printf("%.17g,%.17g,%.17g,%.17g\n", 1e-3 * k, forces.force[0], forces.force[2], forces.torque[1]);
    }
    return call(LATSCH_ENDSIM, &tire, NULL, NULL);
}
