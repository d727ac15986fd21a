!> *PLASTIC, *CYCLIC HARDENING, *RATE DEPENDENT and *VISCOPLASTIC: the flow stress of a metal.
!>
!> Each card fills its own part of the law, in any order; what needs the whole material or the steps
!> is left to module settle_flow.
module lopin_build_plastic
   use lopin_kinds, only : wp
   use lopin_error, only : log_type, location_type
   use lopin_text, only : to_text
   use lopin_model, only : material_type
   use lopin_flow_curve, only : flow_type, table_flow, swift_flow, voce_flow, hollomon_flow, &
      & linear_flow, give_viscosity, hardening_of
   use lopin_block, only : block_type, field_type, split_fields, field_real, complain, line_place, &
      & has_parameter
   use lopin_build_scene, only : need_real, get_word
   use lopin_build_yield, only : read_kinematic, read_combined, read_cyclic_parameters
   implicit none
   private
   public :: read_plastic, read_cyclic_hardening, read_rate_dependent, read_viscoplastic

contains

   subroutine read_plastic(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(flow_type) :: curve
      logical :: found, only, right
      character(len=:), allocatable :: word
      type(location_type) :: at

      if (material%plastic_at%line > 0) then
         call complain(log, 'E0205', 'material `'//material%name//'` has a second *PLASTIC', &
            & block%at)
         return
      end if
      material%plastic_at = block%at
      call get_word(block, 'HARDENING', word, at, found)
      if (.not. found) word = 'ISOTROPIC'
      if (word == 'ISOTROPIC') then
         call read_table(material, block, curve, right, log)
      else if (word == 'KINEMATIC') then
         call read_kinematic(material, block, curve, right, log)
      else if (word == 'COMBINED') then
         call read_combined(material, block, curve, right, log)
      else
         call read_law(material, block, word, curve, right, log)
      end if
      call get_word(block, 'ONLY', word, at, only)
      if (only .and. word /= 'FRICTION') call complain(log, 'E0106', 'ONLY='//word// &
         & ' is not known', at, help='ONLY=FRICTION: the body stays elastic')
      if (.not. right) return
      if (only) then
         call take_curve(material%friction_flow, curve)
      else
         call take_curve(material%flow, curve)
      end if
   end subroutine read_plastic

   !> The hardening of one law in the place of that of another, which keeps its viscosity.
   subroutine take_curve(flow, curve)
      type(flow_type), intent(inout) :: flow
      type(flow_type), intent(in) :: curve

      flow%hardening = curve%hardening
      flow%constant = curve%constant
      if (curve%hardening /= hardening_of%table) return
      flow%strain = curve%strain
      flow%stress = curve%stress
      if (allocated(flow%temperature)) deallocate (flow%temperature, flow%first)
      if (.not. allocated(curve%temperature)) return
      flow%temperature = curve%temperature
      flow%first = curve%first
   end subroutine take_curve

   !> How the size of a surface that moves grows: a table as that of *PLASTIC, or three constants.
   subroutine read_cyclic_hardening(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(flow_type) :: curve
      logical :: right

      if (.not. material%cyclic) then
         call complain(log, 'E0203', &
            & '*CYCLIC HARDENING belongs to *PLASTIC, HARDENING=COMBINED, '// &
            & 'which material `'//material%name//'` has not', block%at, &
            & help='*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS before it')
         return
      end if
      if (material%cyclic_at%line > 0) call complain(log, 'E0205', 'material `'//material%name// &
         & '` has a second *CYCLIC HARDENING', block%at)
      material%cyclic_at = block%at
      if (has_parameter(block, 'PARAMETERS')) then
         call read_cyclic_parameters(block, curve, right, log)
      else
         call read_table(material, block, curve, right, log)
      end if
      if (right) call take_curve(material%flow, curve)
   end subroutine read_cyclic_hardening

   !> Lines `yield stress, plastic strain, temperature`: strains from 0 upwards, for each
   !> temperature.
   subroutine read_table(material, block, curve, right, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(flow_type), intent(out) :: curve
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      real(wp) :: row(3), before(3), table(3, block%nline)
      integer :: first(block%nline + 1), j, n
      logical :: found

      if (block%nline == 0) call complain(log, 'E0103', '*'//block%keyword// &
         & ' needs a yield stress', block%at)
      right = block%nline > 0
      n = 0
      before = 0.0_wp
      do j = 1, block%nline
         call read_row(block, j, row, found, log)
         right = right .and. found
         if (j == 1 .or. abs(row(3) - before(3)) > 0.0_wp) then
            call start_table(block, j, row, before, log)
            n = n + 1
            first(n) = j
         else
            if (.not. row(2) > before(2)) call complain(log, 'E0203', 'plastic strain ' &
               & //to_text(row(2), 6)//' does not increase', line_place(block%line(j)))
            material%hardens = material%hardens .or. row(1) > table(1, first(n))
         end if
         before = row
         table(:, j) = row
      end do
      if (.not. right) return
      first(n + 1) = block%nline + 1
      curve = table_flow(table(2, :), table(1, :))
      if (n == 1) return
      curve%temperature = table(3, first(:n))
      curve%first = first(:n + 1)
   end subroutine read_table

   !> Stress, strain = 0, temperature = 0 of a line.
   subroutine read_row(block, j, row, right, log)
      type(block_type), intent(in) :: block
      integer, intent(in) :: j
      real(wp), intent(out) :: row(3)
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: n
      logical :: found

      row = 0.0_wp
      call split_fields(block%line(j), field, n)
      call need_real(field(1), row(1), log, right)
      if (n > 1) call field_real(field(2), row(2), log, found)
      if (n > 2) call field_real(field(3), row(3), log, found)
      if (.not. row(1) > 0.0_wp) call complain(log, 'E0203', 'a yield stress of ' &
         & //to_text(row(1), 6)//' is not positive', field(1)%at)
   end subroutine read_row

   !> The first line of a temperature: plastic strain 0, above the temperature before.
   subroutine start_table(block, j, row, before, log)
      type(block_type), intent(in) :: block
      integer, intent(in) :: j
      real(wp), intent(in) :: row(3), before(3)
      type(log_type), intent(inout) :: log
      type(location_type) :: at

      at = line_place(block%line(j))
      if (abs(row(2)) > 0.0_wp) call complain(log, 'E0203', 'the first plastic strain is ' &
         & //to_text(row(2), 6)//', not 0', at, help='yield stress at plastic strain 0 first')
      if (j > 1 .and. .not. row(3) > before(3)) call complain(log, 'E0203', 'temperature ' &
         & //to_text(row(3), 6)//' does not increase', at, help='the lines of one temperature '// &
         & 'together, the coldest first')
   end subroutine start_table

   !> One line of constants of a hardening law by name.
   subroutine read_law(material, block, word, curve, right, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: word
      type(flow_type), intent(out) :: curve
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      real(wp) :: c(4)

      material%hardens = .true.
      select case (word)
      case ('SWIFT')
         call read_constants(block, ['K ', 'e0', 'n '], 3, c, right, log)
         if (right) call need_positive(block, c(:2), ['K ', 'e0'], right, log)
         if (right) call need_exponent(block, 'n', c(3), right, log)
         if (right) curve = swift_flow(c(1), c(2), c(3))
      case ('VOCE')
         call read_constants(block, ['S', 'Y', 'd', 'H'], 3, c, right, log)
         if (right) call need_positive(block, c(:2), ['S', 'Y'], right, log)
         if (right .and. min(c(3), c(4)) < 0.0_wp) then
            call complain(log, 'E0203', 'd and H of Voce''s law are not negative', &
               & line_place(block%line(1)))
            right = .false.
         end if
         if (right) curve = voce_flow(c(1), c(2), c(3), c(4))
      case ('HOLLOMON')
         call read_constants(block, ['K', 'n', 'Y'], 2, c, right, log)
         if (right) call need_positive(block, c(:1), ['K'], right, log)
         if (right) call need_exponent(block, 'n', c(2), right, log)
         material%starts_elastic = right .and. .not. c(3) > 0.0_wp
         if (right) curve = hollomon_flow(c(1), c(2), merge(c(3), c(1), c(3) > 0.0_wp))
      case default
         call read_constants(block, ['Y', 'H'], 1, c, right, log)
         if (right) call need_positive(block, c(:1), ['Y'], right, log)
         if (right .and. c(2) < 0.0_wp) then
            call complain(log, 'E0203', 'a straight line that falls ends at no stress', &
               & line_place(block%line(1)), help='write a table, which ends where it ends')
            right = .false.
         end if
         if (right) curve = linear_flow(c(1), c(2))
         material%hardens = c(2) > 0.0_wp
      end select
   end subroutine read_law

   !> The numbers of the only data line; those beyond `least` are 0 where they are missing.
   subroutine read_constants(block, names, least, value, right, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: names(:)
      integer, intent(in) :: least
      real(wp), intent(out) :: value(4)
      logical, intent(out) :: right
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      character(len=:), allocatable :: wanted
      integer :: i, n
      logical :: found

      value = 0.0_wp
      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      wanted = trim(names(1))
      do i = 2, size(names)
         wanted = wanted//', '//trim(names(i))
      end do
      right = n >= least
      if (.not. right) call complain(log, 'E0103', '*'//block%keyword//' needs '//wanted// &
         & ' on one line', block%at, help="lopin doc '*"//block%keyword//"'")
      do i = 1, min(n, size(names))
         if (i > least .and. len_trim(field(i)%text) == 0) cycle
         call need_real(field(i), value(i), log, found)
         right = right .and. found
      end do
      if (n > size(names)) call complain(log, 'E0103', '*'//block%keyword//' has '//wanted// &
         & ' and no more', field(n)%at)
      if (block%nline > 1) call complain(log, 'E0103', '*'//block%keyword//' has one line', &
         & line_place(block%line(2)))
   end subroutine read_constants

   subroutine need_positive(block, value, names, right, log)
      type(block_type), intent(in) :: block
      real(wp), intent(in) :: value(:)
      character(len=*), intent(in) :: names(:)
      logical, intent(inout) :: right
      type(log_type), intent(inout) :: log
      integer :: i

      do i = 1, size(value)
         if (value(i) > 0.0_wp) cycle
         call complain(log, 'E0203', trim(names(i))//' = '//to_text(value(i), 6)// &
            & ' is not positive', line_place(block%line(1)))
         right = .false.
      end do
   end subroutine need_positive

   !> Above 0 and not above 1.
   subroutine need_exponent(block, name, value, right, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: value
      logical, intent(inout) :: right
      type(log_type), intent(inout) :: log

      if (value > 0.0_wp .and. value <= 1.0_wp) return
      call complain(log, 'E0203', 'the exponent '//name//' = '//to_text(value, 6)// &
         & ' is outside (0, 1]', line_place(block%line(1)))
      right = .false.
   end subroutine need_exponent

   !> `D, p` of the power law.
   subroutine read_rate_dependent(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      real(wp) :: c(4)
      logical :: right

      if (material%flow%rate > 0.0_wp) call complain(log, 'E0205', 'material `'//material%name// &
         & '` has a second *RATE DEPENDENT', block%at)
      call read_constants(block, ['D', 'p'], 2, c, right, log)
      if (right) call need_positive(block, c(:2), ['D', 'p'], right, log)
      if (.not. right) return
      material%viscous_at = block%at
      material%flow%rate = c(1)
      material%flow%power = c(2)
   end subroutine read_rate_dependent

   !> `K, m` of Norton and Hoff.
   subroutine read_viscoplastic(material, block, log)
      type(material_type), intent(inout) :: material
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      real(wp) :: c(4)
      logical :: right

      if (material%flow%consistency > 0.0_wp) call complain(log, 'E0205', 'material `'// &
         & material%name//'` has a second *VISCOPLASTIC', block%at)
      material%flow%rigid = has_parameter(block, 'RIGID')
      call read_constants(block, ['K', 'm'], 2, c, right, log)
      if (right) call need_positive(block, c(:1), ['K'], right, log)
      if (right) call need_exponent(block, 'm', c(2), right, log)
      if (.not. right) return
      material%viscous_at = block%at
      call give_viscosity(material%flow, c(1), c(2))
   end subroutine read_viscoplastic
end module lopin_build_plastic
