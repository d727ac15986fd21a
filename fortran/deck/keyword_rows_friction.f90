!> Rows of the keyword table: friction, and what changes it in a step.
module lopin_keyword_rows_friction
   use lopin_friction, only : law_names, law_data, law_notes, regularization_names
   use lopin_keyword_table, only : keyword_table_type, key, flag, word, number, choice, &
      & ignored_flag, later_flag, required, refuses, respells, data_line, example, under, about
   use lopin_text, only : join
   implicit none
   private
   public :: add_friction_rows

contains

   !> Friction, and what changes it in a step.
   subroutine add_friction_rows(table)
      type(keyword_table_type), intent(inout) :: table

      call add_friction(table)
      call add_changes(table)
   end subroutine add_friction_rows

   subroutine add_friction(table)
      type(keyword_table_type), intent(inout) :: table
      integer :: i

      call key(table, 'FRICTION', 'MS', 'both', &
         & 'Friction of a contact: a law bounds the shear, slip opposes it.')
      call under(table, 'SURFACE INTERACTION,CHANGE FRICTION')
      call choice(table, 'LAW', join(law_names, ',')//',AUTO', trim(law_names(1)), &
         & 'What bounds the shear. AUTO: elastic slave COULOMB, perfectly plastic TRESCA, '// &
         & 'hardening CRISTESCU, viscoplastic NORTON-HOFF.')
      call respells(table, 'CRITESCU=CRISTESCU,OROWAN=COULOMB-OROWAN,NORTON=NORTON-HOFF')
      call choice(table, 'REGULARIZATION', trim(regularization_names(1))//',NONE,'// &
         & join(regularization_names(2:), ','), trim(regularization_names(1)), &
         & 'LINEAR: return to the disc. NONE: the same without elastic slip. The others have '// &
         & 'no stick: the shear is a function of slip/ELASTIC SLIP or speed/V0.')
      call choice(table, 'EQUIVALENT', 'MISES', '', &
         & 'TRESCA with the von Mises stress in place of the yield stress, which is CRISTESCU.')
      call flag(table, 'ROUGH', 'No slip at all.')
      call flag(table, 'EXPONENTIAL DECAY', 'From static to kinetic friction with the speed of '// &
         & 'slip.')
      call number(table, 'TAUMAX', '', 'Largest shear, whatever the law [stress].')
      call flag(table, 'LAGRANGE', 'Exact stick also with a penalty method.')
      call number(table, 'ELASTIC SLIP', '', 'Slip before sliding; u0 of a regularisation '// &
         & '[length].')
      call number(table, 'SLIP TOLERANCE', '0.005', 'Elastic slip as a fraction of a facet, '// &
         & 'with a penalty method or where it is given.')
      call number(table, 'V0', '', 'Speed of slip of a regularisation [length/time].')
      call later_flag(table, 'ANISOTROPIC', 'Two coefficients.')
      call later_flag(table, 'DEPENDENCIES', 'Field variables.')
      call later_flag(table, 'TEST DATA', 'Decay fitted to measurements.')
      call later_flag(table, 'SHEAR TRACTION SLOPE', 'Stick slope: write it as the second datum.')
      call later_flag(table, 'USER', 'Subroutine of the user.')
      call data_line(table, 'mu = 0, stick slope [stress/length]', 'COULOMB, as CalculiX.', &
         & 'LAW=COULOMB')
      call data_line(table, 'mu = 0, slip rate [length/time], pressure [stress], temperature', &
         & 'COULOMB, as Abaqus: three or more data; mu must not vary.')
      call data_line(table, 'mu static, mu kinetic, decay [time/length]', 'EXPONENTIAL DECAY.')
      do i = 2, size(law_names)
         call data_line(table, trim(law_data(i)), trim(law_names(i))//': '//trim(law_notes(i)), &
            & 'LAW='//trim(law_names(i)))
      end do
      call data_line(table, 'mu, m, alpha [stress*(time/length)^q], q', 'AUTO: what the law '// &
         & 'chosen needs.', 'LAW=AUTO')
      call example(table, '*SURFACE INTERACTION, NAME=GREASE|*FRICTION, LAW=COULOMB-OROWAN, '// &
         & 'ELASTIC SLIP=1.e-3|0.12, 0.4')
      call about(table, 'E')
   end subroutine add_friction

   subroutine add_changes(table)
      type(keyword_table_type), intent(inout) :: table

      call key(table, 'CHANGE FRICTION', 'S', 'both', &
         & 'Replaces the friction of an interaction from this step on; *FRICTION follows.')
      call word(table, 'INTERACTION', 'Name of the *SURFACE INTERACTION.')
      call required(table)
      call ignored_flag(table, 'RESET', 'Back to the friction of the model: write it again.')
      call example(table, '*STEP|*STATIC|*CHANGE FRICTION, INTERACTION=GREASE|*FRICTION|0.3|'// &
         & '*END STEP')
      call about(table, 'E')

      call key(table, 'CHANGE SURFACE BEHAVIOR', 'S', 'CalculiX', &
         & 'Replaces the behaviour of an interaction from this step on; *SURFACE BEHAVIOR '// &
         & 'follows. Pairs go on from what they bear; friction stays.')
      call word(table, 'INTERACTION', 'Name of the *SURFACE INTERACTION.')
      call required(table)
      call example(table, '*STEP|*STATIC|*CHANGE SURFACE BEHAVIOR, INTERACTION=GREASE|'// &
         & '*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR|1.e5|*END STEP')
      call about(table, 'D')

      call key(table, 'MODEL CHANGE', 'S', 'both', &
         & 'Takes contact pairs out of the model, or puts them back, from this step on.')
      call choice(table, 'TYPE', 'CONTACT PAIR', '', 'What is changed.')
      call required(table)
      call refuses(table, 'ELEMENT')
      call flag(table, 'ADD', 'The pairs act again.')
      call flag(table, 'REMOVE', 'The pairs act no more.')
      call data_line(table, 'slave surface, master surface', 'One pair a line.')
      call example(table, '*STEP|*STATIC|*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE|TOP, PUNCH|'// &
         & '*END STEP')
      call about(table, 'D')
   end subroutine add_changes
end module lopin_keyword_rows_friction
