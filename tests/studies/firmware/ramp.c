/* A ramp that is told what to do: "acceleration limit" first, then "H goal", "A elapsed_us", "C"; tells its speed. */
#include <inttypes.h>
#include <stdio.h>

#include "ramp.h"

int main(void)
{
    struct ramp ramp = {0, 0, 0, 0};
    int64_t number = 0;
    char word = 0;
    if (scanf("%" SCNu32 " %" SCNu16, &ramp.acceleration, &ramp.limit) != 2)
        return 1;
    while (scanf(" %c %" SCNd64, &word, &number) == 2) {
        if (word == 'H')
            ramp_head_for(&ramp, (int16_t)number);
        else if (word == 'C')
            ramp_cut(&ramp);
        const int16_t speed = ramp_advance(&ramp, word == 'A' ? (uint32_t)number : 0);
        printf("%d %" PRId64 "\n", speed, ramp.millionths);
    }
    return 0;
}
