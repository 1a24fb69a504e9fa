/* Carry-save adders for one type of bitmap: included with
 *   CELLS     the type
 *   ADDER(x)  the name of x for it
 *   SUM3, CARRY3  XOR and majority of three of them
 * and for an instruction set (vector.h).
 */

/* Numbers of three bits, cell by cell. */
typedef struct {
    CELLS ones, twos, fours;
} ADDER(three_bits);

/* In how many of seven bitmaps each cell is set. */
static inline TARGET __attribute__((always_inline)) ADDER(three_bits) ADDER(sum_of_seven)(const CELLS *plane)
{
    const CELLS sum = SUM3(plane[0], plane[1], plane[2]), more = SUM3(plane[3], plane[4], plane[5]);
    const CELLS carry1 = CARRY3(plane[0], plane[1], plane[2]), carry2 = CARRY3(plane[3], plane[4], plane[5]);
    const CELLS carry3 = CARRY3(sum, more, plane[6]);
    return (ADDER(three_bits)){SUM3(sum, more, plane[6]), SUM3(carry1, carry2, carry3), CARRY3(carry1, carry2, carry3)};
}

/* Adds them to the lowest planes of a bit-sliced counter, `stride` bitmaps apart; returns what is carried to the fourth. */
static inline TARGET __attribute__((always_inline)) CELLS ADDER(add_three_bits)(CELLS *counter, int stride,
                                                                                ADDER(three_bits) number)
{
    const CELLS n0 = counter[0], n1 = counter[stride], n2 = counter[2 * stride];
    CELLS carry = n0 & number.ones;
    counter[0] = n0 ^ number.ones;
    counter[stride] = SUM3(n1, number.twos, carry);
    carry = CARRY3(n1, number.twos, carry);
    counter[2 * stride] = SUM3(n2, number.fours, carry);
    return CARRY3(n2, number.fours, carry);
}

/* Carries one bit a cell on from a plane to the last; returns what does not fit. */
static inline TARGET __attribute__((always_inline)) CELLS ADDER(carry_on)(CELLS *counter, int stride, int32_t bit,
                                                                          int32_t bits, CELLS carry)
{
    for (; bit < bits; bit++) {
        const CELLS old = counter[bit * stride];
        counter[bit * stride] = old ^ carry;
        carry &= old;
    }
    return carry;
}

#undef CELLS
#undef ADDER
#undef SUM3
#undef CARRY3
