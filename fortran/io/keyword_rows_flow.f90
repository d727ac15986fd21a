!> Rows of the keyword table about materials that flow or expand, and their state at the start.
module lopin_keyword_rows_flow
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, choice, later_flag, &
      & ignored_flag, required, refuses, data_line, example, under, about
   implicit none
   private
   public :: add_flow_rows

contains

   subroutine add_flow_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_plastic(table)
      call add_viscous(table)
      call add_heat(table)
   end subroutine add_flow_rows

   subroutine add_plastic(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'PLASTIC', 'M', 'both', 'Flow curve of von Mises plasticity with '// &
         & 'isotropic hardening; laws of friction read the flow stress at the slave.')
      call under(table, 'MATERIAL')
      call choice(table, 'HARDENING', 'ISOTROPIC,SWIFT,VOCE,HOLLOMON,LINEAR', 'ISOTROPIC', &
         & 'ISOTROPIC: a table; SWIFT: K (e0 + e)^n; VOCE: S - (S - Y) exp(-d e) + H e; '// &
         & 'HOLLOMON: K e^n in the total strain, from yield on; LINEAR: Y + H e. e is the '// &
         & 'accumulated plastic strain.')
      call refuses(table, 'KINEMATIC,COMBINED,JOHNSON COOK,USER')
      call choice(table, 'ONLY', 'FRICTION', '', 'FRICTION: the body stays elastic, and only '// &
         & 'laws of friction read the flow stress at plastic strain 0.')
      call later_flag(table, 'RATE', 'Rate of the table.')
      call data_line(table, 'yield stress [stress], plastic strain = 0, temperature', &
         & 'ISOTROPIC: true stress against logarithmic plastic strain; strains increase from '// &
         & '0, and the stress stays that of the last line beyond it. One temperature at most.')
      call data_line(table, 'K [stress], e0, n', 'SWIFT: one line.')
      call data_line(table, 'S [stress], Y [stress], d, H [stress] = 0', 'VOCE: one line; '// &
         & 'saturation, yield stress, decay, last slope.')
      call data_line(table, 'K [stress], n, Y [stress]', 'HOLLOMON: one line; without Y the '// &
         & 'curve begins where it leaves the line of Young''s modulus.')
      call data_line(table, 'Y [stress], H [stress] = 0', 'LINEAR: one line.')
      call example(table, '*MATERIAL, NAME=DC04|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., 0.2')
      call about(table, 'E')
   end subroutine add_plastic

   subroutine add_viscous(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'RATE DEPENDENT', 'M', 'both', 'Flow stress that grows with the rate of '// &
         & 'plastic strain: factor 1 + (rate/D)^(1/p) on the curve of *PLASTIC (Cowper and '// &
         & 'Symonds). Needs steps with a period.')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'POWER LAW', 'POWER LAW', 'Kind of dependence.')
      call refuses(table, 'YIELD RATIO,JOHNSON COOK')
      call data_line(table, 'D [1/time], p', 'One line.')
      call example(table, '*MATERIAL, NAME=DC04|*ELASTIC|210000., 0.3|*PLASTIC|180., 0.|320., '// &
         & '0.2|*RATE DEPENDENT|40., 5.')
      call about(table, 'G')

      call key(table, 'VISCOPLASTIC', 'M', 'lopin', 'Viscoplastic flow of Norton and Hoff: the '// &
         & 'flow stress is K sqrt(3)^(m+1) rate^m in uniaxial tension. With *PLASTIC it is '// &
         & 'added to that curve, which becomes a threshold. Needs steps with a period.')
      call under(table, 'MATERIAL')
      call choice(table, 'LAW', 'NORTON-HOFF', 'NORTON-HOFF', 'Kind of viscosity.')
      call flag(table, 'RIGID', 'No elastic deviator: all of the strain is flow, and the '// &
         & 'volume is kept. *ELASTIC is not needed; where it stands, its bulk modulus is taken.')
      call data_line(table, 'K [stress time^m], m', 'One line; m between 0 and 1.')
      call example(table, '*MATERIAL, NAME=HOT STEEL|*VISCOPLASTIC, LAW=NORTON-HOFF, '// &
         & 'RIGID|100., 0.2')
      call about(table, 'G')
   end subroutine add_viscous

   subroutine add_heat(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'EXPANSION', 'M', 'both', 'Thermal expansion: strain alpha (T - T0) in '// &
         & 'every direction, T from *TEMPERATURE, T0 from *INITIAL CONDITIONS; logarithmic '// &
         & 'under NLGEOM.')
      call under(table, 'MATERIAL')
      call choice(table, 'TYPE', 'ISO', 'ISO', 'Kind of expansion.')
      call refuses(table, 'ORTHO,ANISO')
      call ignored_flag(table, 'ZERO', 'Temperature at which a coefficient that varies is '// &
         & 'counted from; a constant one does not read it.')
      call data_line(table, 'alpha [1/temperature], temperature', 'One line; a temperature is '// &
         & 'read past.')
      call example(table, '*MATERIAL, NAME=STEEL|*ELASTIC|210000., 0.3|*EXPANSION|1.2e-5')

      call key(table, 'INITIAL CONDITIONS', 'M', 'both', 'State before the first step.')
      call choice(table, 'TYPE', 'TEMPERATURE,STRESS', '', 'TEMPERATURE of nodes, where '// &
         & 'nothing is strained; STRESS in elements, which need not be in balance.')
      call required(table)
      call refuses(table, 'HARDENING,PLASTIC STRAIN,DISPLACEMENT,VELOCITY,FIELD,PRESSURE,SOLUTION')
      call data_line(table, 'node or set, temperature [temperature]', 'TEMPERATURE: as many '// &
         & 'lines as needed; 0 where none is given.')
      call data_line(table, 'element or set, S11 [stress], S22 = 0, S33 = 0, S12 = 0, S13 = 0, '// &
         & 'S23 = 0', 'STRESS: as many lines as needed.')
      call example(table, '*INITIAL CONDITIONS, TYPE=TEMPERATURE|BODY, 20.')

      call key(table, 'TEMPERATURE', 'S', 'both', 'Temperatures of nodes at the end of the '// &
         & 'step; they go there linearly from those before, or with an amplitude.')
      call choice(table, 'OP', 'MOD,NEW', 'MOD', 'NEW: nodes that are not listed go back to '// &
         & 'their temperature at the start.')
      call word(table, 'AMPLITUDE', 'Amplitude by which the temperatures are multiplied.')
      call later_flag(table, 'FILE', 'Temperatures from another run.')
      call later_flag(table, 'BSTEP', 'Temperatures from another run.')
      call later_flag(table, 'BINC', 'Temperatures from another run.')
      call later_flag(table, 'ESTEP', 'Temperatures from another run.')
      call later_flag(table, 'EINC', 'Temperatures from another run.')
      call data_line(table, 'node or set, temperature [temperature]', 'As many lines as needed.')
      call example(table, '*STEP|*STATIC|*TEMPERATURE|BODY, 120.|*END STEP')
   end subroutine add_heat
end module lopin_keyword_rows_flow
