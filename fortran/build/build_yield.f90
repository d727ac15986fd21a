!> Yield surfaces that are not von Mises', and hardening that moves them: *POTENTIAL, *PLASTIC,
!> HARDENING=KINEMATIC or COMBINED, and *CYCLIC HARDENING.
module lopin_build_yield
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, location_type
   use lopin_text, only : to_text
   use lopin_model, only : material_type
   use lopin_flow_curve, only : flow_type, linear_flow, voce_flow
   use lopin_yield_hill, only : hill_yield, ratios_of_lankford, is_convex
   use lopin_kinematic_hardening, only : kinematic_type, most_parts
   use lopin_block, only : block_type, field_type, split_fields, field_real, complain, line_place
   use lopin_build_scene, only : need_real, get_word
   implicit none
   private
   public :: read_potential, read_kinematic, read_combined, read_cyclic_parameters

contains

   !> `*POTENTIAL, TYPE=HILL`: six ratios of yield stresses, or three of Lankford's numbers.
   subroutine read_potential(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: word
      type(location_type) :: at
      real(wp) :: value(6)
      logical :: right, found

      if (material%potential_at%line > 0) call complain(log, 'E0205', 'material `'// &
         & material%name//'` has a second *POTENTIAL', block%at)
      material%potential_at = block%at
      call get_word(block, 'DEFINITION', word, at, found)
      if (found .and. word == 'LANKFORD') then
         call read_positive(block, 3, ['r0 ', 'r45', 'r90'], value, right, log)
         if (right) value = ratios_of_lankford(value(:3))
      else
         call read_positive(block, 6, ['R11', 'R22', 'R33', 'R12', 'R13', 'R23'], value, right, log)
      end if
      if (.not. right) return
      if (.not. is_convex(value)) then
         call complain(log, 'E0203', 'these ratios close no surface: some stress would never '// &
            & 'make material `'//material%name//'` yield', line_place(block%line(1)), &
            & help='R are yield stresses by the flow stress of *PLASTIC')
         return
      end if
      if (.not. allocated(material%plastic)) allocate (material%plastic)
      if (allocated(material%plastic%yield)) deallocate (material%plastic%yield)
      allocate (material%plastic%yield, source=hill_yield(value))
   end subroutine read_potential

   subroutine read_positive(block, wanted, names, value, right, log)
      type(block_type), intent(in) :: block
      integer, intent(in) :: wanted
      character(len=3), intent(in) :: names(:)
      real(wp), intent(out) :: value(6)
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: list
      integer :: i, n
      logical :: found

      value = 1.0_wp
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      list = trim(names(1))
      do i = 2, wanted
         list = list//', '//trim(names(i))
      end do
      right = n >= wanted .and. block%nline == 1
      if (.not. right) call complain(log, 'E0103', '*'//block%keyword//' needs '//list// &
         & ' on one line', block%at, help="lopin doc '*"//block%keyword//"'")
      do i = 1, min(n, wanted)
         call need_real(field(i), value(i), log, found)
         right = right .and. found
         if (value(i) > 0.0_wp) cycle
         call complain(log, 'E0203', trim(names(i))//' = '//to_text(value(i), 6)// &
            & ' is not positive', field(i)%at)
         right = .false.
      end do
   end subroutine read_positive

   !> A surface that moves: von Mises' unless *POTENTIAL gives another.
   subroutine give_kinematic(material, kinematic)
      type(material_type), intent(inout) :: material
      type(kinematic_type), intent(in) :: kinematic

      if (.not. allocated(material%plastic)) allocate (material%plastic)
      material%plastic%kinematic = kinematic
      if (allocated(material%plastic%yield)) return
      allocate (material%plastic%yield, source=hill_yield(spread(1.0_wp, 1, 6)))
   end subroutine give_kinematic

   !> Two lines `yield stress, plastic strain`: linear kinematic hardening.
   subroutine read_kinematic(material, block, curve, right, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(flow_type), intent(out) :: curve
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      type(kinematic_type) :: kinematic
      real(wp) :: stress(2), strain(2)
      integer :: j, n
      logical :: found

      right = block%nline == 2
      if (.not. right) then
         call complain(log, 'E0103', &
            & 'HARDENING=KINEMATIC is a straight line: a yield stress at '// &
            & 'plastic strain 0 and another at a strain above it, on two lines', block%at, &
            & help='HARDENING=COMBINED has curves')
         return
      end if
      strain = 0.0_wp
      do j = 1, 2
         call split_fields(block%line(j), field, n)
         call need_real(field(1), stress(j), log, found)
         right = right .and. found .and. n <= 3
         if (n > 1) call field_real(field(2), strain(j), log, found)
         if (n <= 2) cycle
         if (len_trim(field(3)%text) == 0) cycle
         call complain(log, 'E0108', 'kinematic hardening that depends on temperature comes '// &
            & 'with a later version', field(3)%at, help='leave the temperature out')
         right = .false.
      end do
      if (.not. right) return
      right = stress(1) > 0.0_wp .and. .not. abs(strain(1)) > 0.0_wp .and. strain(2) > 0.0_wp &
         & .and. stress(2) >= stress(1)
      if (.not. right) then
         call complain(log, 'E0203', 'kinematic hardening goes from a positive yield stress at '// &
            & 'plastic strain 0 up to another', line_place(block%line(1)))
         return
      end if
      kinematic%n = 1
      kinematic%modulus(1) = (stress(2) - stress(1))/strain(2)
      call give_kinematic(material, kinematic)
      material%hardens = stress(2) > stress(1)
      curve = linear_flow(stress(1), 0.0_wp)
   end subroutine read_kinematic

   !> `yield stress, C1, gamma1, C2, gamma2, ...`; the size of the surface stays unless *CYCLIC
   !> HARDENING gives it.
   subroutine read_combined(material, block, curve, right, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(flow_type), intent(out) :: curve
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: word
      type(location_type) :: at
      type(kinematic_type) :: kinematic
      real(wp) :: value(1 + 2*most_parts)
      integer :: n
      logical :: found

      right = .false.
      call get_word(block, 'DATA TYPE', word, at, found)
      if (word /= 'PARAMETERS') then
         call complain(log, 'E0108', 'HARDENING=COMBINED from a test comes with a later version', &
            & block%at, help='DATA TYPE=PARAMETERS: yield stress, C1, gamma1, C2, gamma2, ...')
         return
      end if
      call read_values(block, value, n, right, log)
      if (.not. right) return
      right = n >= 3 .and. mod(n, 2) == 1 .and. value(1) > 0.0_wp .and. minval(value(:n)) >= 0.0_wp
      if (.not. right) then
         call complain(log, 'E0203', &
            & 'HARDENING=COMBINED has a yield stress above 0 and pairs of '// &
            & 'C and gamma, none negative', line_place(block%line(1)), &
            & help='yield stress, C1, gamma1, C2, gamma2, ...')
         return
      end if
      kinematic%n = (n - 1)/2
      kinematic%modulus(:kinematic%n) = value(2:n:2)
      kinematic%recovery(:kinematic%n) = value(3:n:2)
      call give_kinematic(material, kinematic)
      material%hardens = any(kinematic%modulus > 0.0_wp)
      material%cyclic = .true.
      curve = linear_flow(value(1), 0.0_wp)
   end subroutine read_combined

   !> Numbers of all lines of a block, one behind the other, up to the number of backstresses.
   subroutine read_values(block, value, n, right, log)
      type(block_type), intent(in) :: block
      real(wp), intent(out) :: value(:)
      integer, intent(out) :: n
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: i, j, m, wanted
      real(wp) :: parts
      logical :: found

      value = 0.0_wp
      n = 0
      right = block%nline > 0
      if (.not. right) call complain(log, 'E0103', '*'//block%keyword//' needs a yield stress', &
         & block%at)
      do j = 1, block%nline
         call split_fields(block%line(j), field, m)
         do i = 1, m
            if (len_trim(field(i)%text) == 0) cycle
            if (n == size(value)) then
               call complain(log, 'E0203', 'more than '//to_text(most_parts)//' backstresses', &
                  & field(i)%at)
               right = .false.
               return
            end if
            n = n + 1
            call need_real(field(i), value(n), log, found)
            right = right .and. found
         end do
      end do
      call get_word(block, 'NUMBER BACKSTRESSES', word, at, found)
      wanted = (n - 1)/2
      if (found) read (word, *, iostat=i) parts
      if (found) wanted = nint(parts)
      if (n == 1 + 2*wanted .or. .not. right) return
      right = .false.
      if (n == 2 + 2*wanted) then
         call complain(log, 'E0108', &
            & 'kinematic hardening that depends on temperature comes with '// &
            & 'a later version', line_place(block%line(1)), help='leave the temperature out')
      else
         call complain(log, 'E0203', 'NUMBER BACKSTRESSES='//word//' needs '// &
            & to_text(1 + 2*wanted)//' numbers, here are '//to_text(n), block%at)
      end if
   end subroutine read_values

   !> `*CYCLIC HARDENING, PARAMETERS`: size of the surface at the start, Q, b.
   subroutine read_cyclic_parameters(block, curve, right, log)
      type(block_type), intent(in) :: block
      type(flow_type), intent(out) :: curve
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: value(3)
      integer :: i, n
      logical :: found

      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      right = n == 3 .and. block%nline == 1
      if (.not. right) then
         call complain(log, 'E0103', &
            & '*CYCLIC HARDENING, PARAMETERS needs a yield stress, Q and '// &
            & 'b on one line', block%at)
         return
      end if
      do i = 1, 3
         call need_real(field(i), value(i), log, found)
         right = right .and. found
      end do
      if (.not. right) return
      right = value(1) > 0.0_wp .and. value(1) + value(2) > 0.0_wp .and. value(3) >= 0.0_wp
      if (right) then
         curve = voce_flow(value(1) + value(2), value(1), value(3), 0.0_wp)
      else
         call complain(log, 'E0203', 'the size of the yield surface stays positive, b is not '// &
            & 'negative', line_place(block%line(1)))
      end if
   end subroutine read_cyclic_parameters
end module lopin_build_yield
