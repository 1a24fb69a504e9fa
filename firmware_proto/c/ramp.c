#include "ramp.h"

#define MILLION 1000000

void ramp_head_for(struct ramp *ramp, int16_t goal)
{
    const int32_t limit = ramp->limit > INT16_MAX ? INT16_MAX : ramp->limit;
    const int32_t within = goal > limit ? limit : goal;
    ramp->goal = (int16_t)(within < -limit ? -limit : within);
}

int16_t ramp_advance(struct ramp *ramp, uint32_t elapsed_us)
{
    const int64_t missing = (int64_t)ramp->goal * MILLION - ramp->millionths;
    const uint64_t may = (uint64_t)ramp->acceleration * elapsed_us;
    if (may >= (uint64_t)(missing < 0 ? -missing : missing))
        ramp->millionths += missing;
    else
        ramp->millionths += missing < 0 ? -(int64_t)may : (int64_t)may;
    return (int16_t)(ramp->millionths / MILLION);
}

void ramp_cut(struct ramp *ramp)
{
    ramp->goal = 0;
    ramp->millionths = 0;
}
