!> `*SURFACE INTERACTION` with `*SURFACE BEHAVIOR` and `*FRICTION`: which method, which law.
!>
!> | deck                                                     | method                    |
!> | nothing, DIRECT, PRESSURE-OVERCLOSURE=HARD                | lagrange                  |
!> | PENALTY; PRESSURE-OVERCLOSURE=LINEAR, EXPONENTIAL, TABULAR | penalty                   |
!> | DIRECT with one of these; PERTURBED LAGRANGE              | perturbed                 |
!> | AUGMENTED LAGRANGE                                       | augmented                 |
!> | PRESSURE-OVERCLOSURE=TIED with a slope; without           | penalty; lagrange         |
module lopin_build_interactions
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_enforcement, only : copy_method
   use lopin_enforcement_factory, only : new_enforcement, method_names, method_parameters
   use lopin_enforcement_law, only : law_type, new_exponential, new_tabular
   use lopin_model, only : model_type, interaction_type, overclosure_of
   use lopin_interactions, only : new_interaction, add_interaction
   use lopin_block, only : deck_type, block_type, field_type, split_fields, field_real, &
      & complain, has_parameter, line_place
   use lopin_build_friction, only : read_friction
   use lopin_build_scene, only : need_real, scene_type, need_word, get_word
   implicit none
   private
   public :: build_interactions, read_behaviour

contains

   subroutine build_interactions(model, deck, scene)
      type(model_type), intent(inout) :: model
      type(deck_type), intent(in) :: deck
      type(scene_type), intent(in) :: scene
      type(interaction_type) :: interaction
      type(location_type) :: at
      integer :: k, i
      logical :: open, described, rubbed

      allocate (model%interaction(0))
      open = .false.
      described = .false.
      rubbed = .false.
      do k = 1, scene%ncard
         associate (block => deck%block(scene%card(k)%block), n => size(model%interaction))
            select case (block%keyword)
            case ('SURFACE INTERACTION')
               call new_interaction(interaction)
               described = .false.
               rubbed = .false.
               call need_word(block, 'NAME', interaction%name, at, open, model%log)
               interaction%at = at
               if (.not. open) cycle
               do i = 1, n
                  if (model%interaction(i)%name == interaction%name) call complain(model%log, &
                     & 'E0205', &
                     & 'surface interaction `'//interaction%name &
                     & //'` is defined twice, first in line ' &
                     & //to_text(model%interaction(i)%at%line), at)
               end do
               call add_interaction(model, interaction)
            case ('SURFACE BEHAVIOR', 'FRICTION')
               if (scene%card(k)%step > 0) cycle
               if (.not. open) then
                  call complain(model%log, 'E0306', '*'//block%keyword &
                     & //' stands outside a surface interaction', &
                     & block%at, help='write *SURFACE INTERACTION, NAME= before it')
               else if (block%keyword == 'FRICTION') then
                  call take_friction(model%interaction(n), block, rubbed, model%log)
               else if (described) then
                  call complain(model%log, 'E0205', 'interaction `'//model%interaction(n)%name &
                     & //'` has a second *SURFACE BEHAVIOR', block%at)
               else
                  described = .true.
                  call read_behaviour(model%interaction(n), block, model%log)
               end if
            end select
         end associate
      end do
   end subroutine build_interactions

   !> One *FRICTION an interaction.
   subroutine take_friction(interaction, block, rubbed, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      logical, intent(inout) :: rubbed
      type(log_type), intent(inout) :: log

      if (rubbed) call complain(log, 'E0205', 'interaction `'//interaction%name &
         & //'` has a second *FRICTION', block%at)
      rubbed = .true.
      call read_friction(interaction%friction, block, log)
   end subroutine take_friction

   subroutine read_behaviour(interaction, block, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: law, method
      type(location_type) :: at
      logical :: found, direct, hard
      integer :: i

      call get_word(block, 'PRESSURE-OVERCLOSURE', law, at, found)
      if (.not. found) law = 'HARD'
      if (has_parameter(block, 'PERTURBED LAGRANGE') .and. .not. found) law = 'LINEAR'
      direct = has_parameter(block, 'DIRECT')
      hard = law == 'HARD'
      interaction%no_separation = has_parameter(block, 'NO SEPARATION')
      select case (law)
      case ('LINEAR')
         interaction%overclosure = overclosure_of%linear
      case ('EXPONENTIAL')
         interaction%overclosure = overclosure_of%exponential
      case ('TABULAR')
         interaction%overclosure = overclosure_of%tabular
      case ('TIED')
         interaction%overclosure = overclosure_of%tied
      case default
         interaction%overclosure = overclosure_of%hard
      end select
      method = 'lagrange'
      if (.not. hard .and. law /= 'TIED') method = trim(merge('perturbed', 'penalty  ', direct))
      do i = 1, size(method_names)
         if (method_parameters(i) == 'DIRECT') cycle
         if (has_parameter(block, trim(method_parameters(i)))) method = trim(method_names(i))
      end do
      call new_enforcement(interaction%method, method)
      call check_one_method(block, log)
      if (law == 'TABULAR' .or. law == 'EXPONENTIAL') call free_law(interaction, block, law, log)
      select case (law)
      case ('TABULAR')
         call read_table(interaction, block, log)
      case ('EXPONENTIAL')
         call read_exponential(interaction, block, log)
      case default
         call read_slope(interaction, block, law, log)
      end select
      if (law /= 'TABULAR' .and. block%nline > 1) call complain(log, 'E0103', &
         & '*SURFACE BEHAVIOR has one data line here', line_place(block%line(2)), &
         & help='a table needs PRESSURE-OVERCLOSURE=TABULAR; or a keyword line is lost above')
      if (law == 'TIED' .and. interaction%slope > 0.0_wp) call new_enforcement( &
         & interaction%method, 'penalty')
   end subroutine read_behaviour

   !> A pressure-overclosure law says all: no method is needed to enforce it, and it does not pull.
   subroutine free_law(interaction, block, law, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: law
      type(log_type), intent(inout) :: log

      if (interaction%method%updates()) then
         call log%say(severity%note, 'N0306', 'AUGMENTED LAGRANGE is not used: '// &
            & 'PRESSURE-OVERCLOSURE='//law//' gives the pressure of every penetration', block%at)
      end if
      if (interaction%no_separation) then
         call log%say(severity%warning, 'W0305', 'NO SEPARATION does nothing here: '// &
            & 'PRESSURE-OVERCLOSURE='//law//' gives no tension', block%at, &
            & help='take PENALTY or DIRECT for surfaces that stay together')
         interaction%no_separation = .false.
      end if
   end subroutine free_law

   subroutine check_one_method(block, log)
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: text
      integer :: i, n

      n = 0
      text = ''
      do i = 1, size(method_parameters)
         if (.not. has_parameter(block, trim(method_parameters(i)))) cycle
         n = n + 1
         if (n > 1) text = text//' and '
         text = text//trim(method_parameters(i))
      end do
      if (n > 1 .and. text /= 'DIRECT and PERTURBED LAGRANGE') call complain(log, 'E0306', &
         & '*SURFACE BEHAVIOR asks for '//text//': one method only', block%at)
   end subroutine check_one_method

   !> `slope, clearance, scale`; with PRESSURE-OVERCLOSURE=LINEAR or TIED the second datum is
   !> CalculiX' tension at a large gap, which Lopin does not have.
   subroutine read_slope(interaction, block, law, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: law
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      real(wp) :: value(3)
      integer :: i, n
      logical :: found, given(3), of_calculix

      if (block%nline == 0) return
      call split_fields(block%line(1), field, n)
      given = .false.
      value = 0.0_wp
      do i = 1, min(3, n)
         call field_real(field(i), value(i), log, given(i))
      end do
      if (given(1) .and. .not. value(1) > 0.0_wp) call complain(log, 'E0306', 'the slope ' &
         & //to_text(value(1), 6) &
         & //' of interaction `'//interaction%name//'` is not positive', field(1)%at, &
         & help='leave it blank to have it chosen from the elements behind the surface')
      if (given(1)) interaction%slope = value(1)
      if (given(1) .and. .not. interaction%method%reads_slope() &
         & .and. law /= 'TIED') call log%say(severity%note, &
         & 'N0306', 'the slope is not used: contact of interaction `'//interaction%name &
         & //'` is hard', field(1)%at)
      found = has_parameter(block, 'PRESSURE-OVERCLOSURE')
      of_calculix = found .and. (law == 'LINEAR' .or. law == 'TIED') &
         & .and. .not. has_parameter(block, 'PENALTY')
      if (given(2) .and. of_calculix) then
         if (abs(value(2)) > 0.0_wp) call log%say(severity%note, 'N0306', 'the second datum ' &
            & //to_text(value(2), 6) &
            & //" is read as CalculiX' tension at a large gap and is not used: " &
            & //'open contact carries nothing', field(2)%at)
      else if (given(2)) then
         interaction%clearance = value(2)
      end if
      if (given(3) .and. .not. of_calculix) then
         interaction%scale = value(3)
         if (.not. value(3) > 0.0_wp) call complain(log, 'E0306', 'the scale factor ' &
            & //to_text(value(3), 6) &
            & //' is not positive', field(3)%at)
      end if
   end subroutine read_slope

   !> `c0, p0`: pressure p0 at gap 0, none at gap c0.
   subroutine read_exponential(interaction, block, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      type(law_type) :: exponential
      real(wp) :: c0, p0
      integer :: n
      logical :: found

      n = 0
      if (block%nline > 0) call split_fields(block%line(1), field, n)
      allocate (interaction%table(2, 1), source=1.0_wp)
      if (n < 2) then
         call complain(log, 'E0103', 'PRESSURE-OVERCLOSURE=EXPONENTIAL needs c0, p0', block%at)
         return
      end if
      call need_real(field(1), c0, log, found)
      call need_real(field(2), p0, log, found)
      if (.not. (c0 > 0.0_wp .and. p0 > 0.0_wp)) call complain(log, 'E0306', 'c0 = ' &
         & //to_text(c0, 6)//' and p0 = ' &
         & //to_text(p0, 6)//' must be positive', line_place(block%line(1)))
      interaction%table(:, 1) = [p0, c0]
      call new_exponential(exponential, p0, c0)
      call log%say(severity%note, 'N0306', 'EXPONENTIAL is the law of Abaqus, without pressure '// &
         & 'beyond the gap c0; in CalculiX a hundredth of p0 is left there, and pressures '// &
         & 'above p0 grow faster', block%at)
      call copy_method(exponential, interaction%method)
   end subroutine read_exponential

   subroutine read_table(interaction, block, log)
      type(interaction_type), intent(inout) :: interaction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      type(law_type) :: tabular
      integer :: j, i, n
      logical :: found

      allocate (interaction%table(2, block%nline), source=0.0_wp)
      do j = 1, block%nline
         call split_fields(block%line(j), field, n)
         do i = 1, min(2, n)
            call field_real(field(i), interaction%table(i, j), log, found)
         end do
         if (j == 1) cycle
         if (.not. all(interaction%table(:, j) > interaction%table(:, j - 1))) then
            call complain(log, 'E0306', 'the table of interaction `'//interaction%name &
               & //'` does not increase', &
               & line_place(block%line(j)), &
               & help='pressure, overclosure: both grow from line to line')
            return
         end if
      end do
      if (block%nline < 2) call complain(log, 'E0103', &
         & 'PRESSURE-OVERCLOSURE=TABULAR needs at least two lines', block%at)
      call new_tabular(tabular, interaction%table(1, :), interaction%table(2, :))
      call copy_method(tabular, interaction%method)
   end subroutine read_table
end module lopin_build_interactions
