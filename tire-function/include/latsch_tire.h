/* A tire that its host steps: motion of the wheel carrier in, force and moment out.
 *
 * A host may evaluate as often and at whatever times it likes: an evaluation steps a copy of the last committed state to the time asked
 * for, and changes nothing. The same committed states and the same motion give the same bits.
 *
 * Which steps count the host says with LATSCH_SSTEP and the motion with which the step ended. A host that never does has its steps
 * committed when it goes on: an evaluation at a later time than the last one commits that last one, which has to be of the motion that
 * it goes on from. Evaluations at a time before the last committed state go back to the last one that is not behind them; the last 64 are
 * kept.
 *
 * Rubber that rides on the rim is not in force and torque, only its weight is: the host's wheel has to be heavier by varinf[8] and to
 * have more inertia about its axis by varinf[9].
 *
 * Axes: those of the road are x forward, y to the left, z up; the wheel turns about y of the carrier, to the left. SI units.
 */
#ifndef LATSCH_TIRE_H
#define LATSCH_TIRE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum latsch_job {
    LATSCH_NORMAL = 0,  /* force and moment for a motion */
    LATSCH_INQUIRE = 1, /* arrays that the host has to have: none */
    LATSCH_INIT = 2,    /* reads the property file (.tir) and the road file (.rdf, .crg, .csv, .toml; NULL: a level road) */
    LATSCH_RESET = 3,   /* reads both files again and forgets all states */
    LATSCH_SSTEP = 4,   /* the step that ended with this motion has succeeded */
    LATSCH_DIFF = 5,    /* as LATSCH_NORMAL */
    LATSCH_ENDSIM = 99  /* frees the tire */
};

/* A tire; a pointer to it begins as NULL and is made by LATSCH_INIT. Not for two threads at once. */
typedef struct latsch_tire_state latsch_tire_state;

typedef struct {
    double time;         /* s */
    double dis[3];       /* the wheel's centre, road axes [m] */
    double tramat[3][3]; /* from carrier axes to road axes: road[i] = sum over j of tramat[i][j] carrier[j] */
    double vel[3];       /* velocity of the centre, carrier axes [m/s] */
    double omega[3];     /* angular velocity of the carrier, carrier axes [rad/s] */
    double angtwc;       /* angle of the wheel against the carrier, positive forward [rad]; whole turns do not count */
    double omegar;       /* its rate [rad/s] */
} latsch_motion;

typedef struct {
    double force[3];  /* on the wheel carrier at the wheel's centre, road axes [N] */
    double torque[3]; /* about the wheel's centre, road axes [N.m] */
    double varinf[10]; /* force [N] and moment [N.m] in H axes (x in the wheel's heading, z up), deflection [m], energy lost in
                          the contact [J], mass [kg] and inertia [kg.m2] that the host's wheel has to carry */
} latsch_forces;

/* 0 if all went well; the message is then empty or says what the user should know. Otherwise 1, a message that says what was wrong, and
 * forces as they were. */
int latsch_tire(int job, latsch_tire_state **tire, const char *property_file, const char *road_file, const latsch_motion *motion,
                latsch_forces *forces, char *message, size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
