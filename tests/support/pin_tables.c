/* Prints for tools/reference what can be at the board's pins: buses and their pins, devices, outputs; and what a wiring file may hold. A line
 * has fields with tabs between them; the first field says what the line is.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>

#include "chips/chip.h"
#include "devices/devices.h"
#include "hal/analog.h"
#include "outputs/output_settings.h"

static void print_pin(hal_pin pin)
{
    printf("\tP%c%u", 'A' + pin / 16, pin % 16u);
}

static void print_buses(void)
{
    hal_pin pins[3];
    for (uint8_t bus = 1; hal_spi_pins(bus, pins); bus++) {
        printf("bus\tspi%u\tclock, in, out", bus);
        for (unsigned k = 0; k < 3; k++)
            print_pin(pins[k]);
        printf("\n");
    }
    for (uint8_t bus = 1; hal_i2c_pins(bus, pins); bus++) {
        printf("bus\ti2c%u\tclock, data", bus);
        for (unsigned k = 0; k < 2; k++)
            print_pin(pins[k]);
        printf("\n");
    }
    for (uint8_t bus = 1; hal_onewire_pin(bus, pins); bus++) {
        printf("bus\twire%u\tdata", bus);
        print_pin(pins[0]);
        printf("\n");
    }
    printf("free");
    for (unsigned pin = 0; pin < 64; pin++)
        if (hal_pin_is_free((hal_pin)pin))
            print_pin((hal_pin)pin);
    printf("\nanalog");
    for (unsigned pin = 0; pin < 64; pin++)
        if (hal_pin_is_free((hal_pin)pin) && hal_analog_has((hal_pin)pin))
            print_pin((hal_pin)pin);
    printf("\n");
}

static void print_devices(void)
{
    static const char *const lines[] = {"a pin", "spi", "i2c", "wire"};
    for (unsigned k = 0; k < DEVICE_KINDS; k++) {
        const struct device_kind *kind = device_kind_at(k);
        printf("device\t%s\t%s\t%s\t%u\n", kind->name, lines[kind->line], kind->unit,
               kind->interval_ms);
    }
    for (unsigned bit = 0; device_fault_text((uint16_t)(1u << bit))[0] != '\0'; bit++)
        printf("fault\t%s\n", device_fault_text((uint16_t)(1u << bit)));
}

static void print_outputs(void)
{
    static const char *const pins[OUTPUT_PINS] = {"pin", "pin2", "end_open", "end_closed",
                                                  "zero_cross"};
    for (uint8_t type = 1; type < OUTPUT_TYPES; type++) {
        printf("output\t%s\t", output_type_name(type));
        for (unsigned k = 0, n = 0; k < OUTPUT_PINS; k++)
            if (output_uses(type, k))
                printf("%s%s", n++ ? ", " : "", pins[k]);
        printf("\t");
        for (size_t k = 0, n = 0; k < output_number_count; k++)
            if ((output_numbers[k].types & OUTPUT_BIT(type)) != 0)
                printf("%s%s", n++ ? ", " : "", output_numbers[k].name);
        printf("\n");
    }
}

static void print_chips(void)
{
    size_t n;
    const struct chip_kind *const *kinds = chip_kinds(&n);
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < kinds[i]->n_properties; k++) {
            const struct chip_property *p = &kinds[i]->properties[k];
            printf("property\t%s\t%s\t%s\t%g\t%g\t%g\t%s\n", kinds[i]->name, p->name, p->unit,
                   p->lo, p->hi, p->at_first, p->form != NULL ? p->form : "");
        }
        for (size_t k = 0; k < kinds[i]->n_inputs; k++) {
            const struct chip_input *in = &kinds[i]->inputs[k];
            printf("input\t%s\t%s\t%s\t%g\t%g\t%s\n", kinds[i]->name, in->name, in->unit, in->lo,
                   in->hi, in->what);
        }
    }
}

int main(void)
{
    print_buses();
    print_devices();
    print_outputs();
    print_chips();
    return 0;
}
