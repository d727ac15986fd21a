!> What several recorders ask alike: is an output due, what did a pair do, what is a row of the
!> history.
module lopin_recorder_table
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, rigid_body_type, is_heated
   use lopin_damage_criteria, only : damage_names
   use lopin_damage, only : damage_kinds
   use lopin_report, only : frame_type, contact_field_type
   use lopin_flow_curve, only : flows
   implicit none
   private
   public :: pair_summary_type, summarise_pair, pair_name, file_word
   public :: is_due, frame_asks, has_variable, any_request
   public :: column_type, history_columns, history_row

   !> A pair in a few numbers. Forces are on the full circumference if axisymmetric.
   type :: pair_summary_type
      real(wp) :: force(3) = 0.0_wp            !! of the master on the slave [force]
      real(wp) :: area = 0.0_wp                !! of the closed points [length^2]
      real(wp) :: max_pressure = 0.0_wp        !! [stress]
      real(wp) :: max_penetration = 0.0_wp     !! >= 0 [length]
      integer :: closed = 0, sticking = 0
   end type pair_summary_type

   type :: column_type
      character(len=:), allocatable :: name        !! e.g. BALL.rf2, TOP-BALL.area
      character(len=:), allocatable :: dimension   !! e.g. force
   end type column_type

   character(len=*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'
   character(len=*), parameter :: file_letters = letters//'0123456789_-'

contains

   pure subroutine summarise_pair(field, summary)
      type(contact_field_type), intent(in) :: field
      type(pair_summary_type), intent(out) :: summary
      integer :: i

      do i = 1, size(field%node)
         summary%force(:size(field%force, 1)) = summary%force(:size(field%force, 1)) &
            & + field%force(:, i)
         if (field%status(i) >= 0) then
            summary%max_penetration = max(summary%max_penetration, -field%gap(i))
         end if
         if (field%status(i) <= 0) cycle
         summary%closed = summary%closed + 1
         if (field%status(i) == 1) summary%sticking = summary%sticking + 1
         summary%area = summary%area + field%weight(i)
         summary%max_pressure = max(summary%max_pressure, field%pressure(i))
      end do
   end subroutine summarise_pair

   !> SLAVE-MASTER, the user's names.
   pure function pair_name(model, i) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      character(len=:), allocatable :: name

      name = model%surface(model%pair(i)%slave)%name
      if (model%pair(i)%master > 0) name = name//'-'//model%surface(model%pair(i)%master)%name
   end function pair_name

   !> A name that is safe in a file name.
   pure function file_word(name) result(word)
      character(len=*), intent(in) :: name
      character(len=len(name)) :: word
      integer :: i

      word = name
      do i = 1, len(word)
         if (index(file_letters, word(i:i)) == 0) word(i:i) = '_'
      end do
   end function file_word

   !> Every `frequency` increments and at the end of the step; frequency 0 is never.
   pure logical function is_due(frequency, frame)
      integer, intent(in) :: frequency
      type(frame_type), intent(in) :: frame

      is_due = .false.
      if (frequency <= 0) return
      is_due = mod(frame%increment, frequency) == 0 .or. frame%last_of_step
   end function is_due

   !> Does the step of a frame ask for one of the variables in this increment?
   pure logical function frame_asks(model, frame, kind, words)
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      integer, intent(in) :: kind
      character(len=*), intent(in) :: words(:)
      integer :: i

      frame_asks = .false.
      associate (output => model%step(frame%step)%output)
         do i = 1, size(output)
            if (output(i)%kind /= kind .or. .not. is_due(output(i)%frequency, frame)) cycle
            if (has_variable(output(i)%variable, words)) frame_asks = .true.
         end do
      end associate
   end function frame_asks

   pure logical function has_variable(list, words)
      character(len=*), intent(in) :: list(:), words(:)
      integer :: i

      has_variable = .false.
      do i = 1, size(list)
         if (any(words == list(i)) .or. any(words == without_digits(list(i)))) has_variable = .true.
      end do
   end function has_variable

   !> Abaqus names components: U2 is of U, S11 of S.
   pure function without_digits(word) result(stem)
      character(len=*), intent(in) :: word
      character(len=len(word)) :: stem
      integer :: last

      last = verify(trim(word), '0123456789', back=.true.)
      stem = word(:last)
   end function without_digits

   !> Is there an output of one of the kinds, with a variable, in any step?
   pure logical function any_request(model, kinds)
      type(model_type), intent(in) :: model
      integer, intent(in) :: kinds(:)
      integer :: i, k

      any_request = .false.
      do i = 1, size(model%step)
         do k = 1, size(model%step(i)%output)
            if (size(model%step(i)%output(k)%variable) == 0) cycle
            if (any(kinds == model%step(i)%output(k)%kind)) any_request = .true.
         end do
      end do
   end function any_request

   !> Names and dimensions of the numbers of `history_row`.
   subroutine history_columns(model, column)
      type(model_type), intent(in) :: model
      type(column_type), allocatable, intent(out) :: column(:)
      integer :: i, k, n
      character(len=:), allocatable :: name
      character(len=1) :: digit

      allocate (column(0))
      call add(column, 'step', '-')
      call add(column, 'increment', '-')
      call add(column, 'time', 'time')
      call add(column, 'iterations', '-')
      call add(column, 'augmentations', '-')
      n = model%mesh%ndim
      do i = 1, size(model%rigid_body)
         name = model%rigid_body(i)%name
         do k = 1, 3*(n - 1)
            digit = achar(iachar('0') + physical_dof(n, k))
            call add(column, name//'.u'//digit, merge('length', 'rad   ', k <= n))
         end do
         do k = 1, 3*(n - 1)
            digit = achar(iachar('0') + physical_dof(n, k))
            call add(column, name//'.rf'//digit, merge('force       ', 'force*length', k <= n))
         end do
      end do
      do i = 1, size(model%pair)
         name = pair_name(model, i)
         do k = 1, n
            call add(column, name//'.force'//achar(iachar('0') + k), 'force')
         end do
         call add(column, name//'.area', 'length^2')
         call add(column, name//'.max_pressure', 'stress')
         call add(column, name//'.max_penetration', 'length')
         call add(column, name//'.closed', '-')
      end do
      call add_sums(model, column)
   end subroutine history_columns

   !> Energies and what else is of the whole model.
   subroutine add_sums(model, column)
      type(model_type), intent(in) :: model
      type(column_type), allocatable, intent(inout) :: column(:)
      integer, allocatable :: kinds(:)
      integer :: i

      allocate (kinds, source=damage_kinds(model))
      call add(column, 'energy.strain', 'force*length')
      call add(column, 'energy.external', 'force*length')
      call add(column, 'energy.contact', 'force*length')
      call add(column, 'energy.friction', 'force*length')
      call add(column, 'energy.friction_mean', 'force*length')
      if (model_flows(model)) then
         call add(column, 'energy.plastic', 'force*length')
         call add(column, 'volume', 'length^3')
      end if
      do i = 1, size(kinds)
         call add(column, 'damage.'//trim(damage_names(kinds(i))), '-')
      end do
      if (is_heated(model)) call add(column, 'energy.thermal', 'force*length')
      call add(column, 'energy.artificial', 'force*length')
      call add(column, 'certificate', '0=PASS 1=WARN 2=FAIL')
   end subroutine add_sums

   subroutine add(column, what, unit)
      type(column_type), allocatable, intent(inout) :: column(:)
      character(len=*), intent(in) :: what, unit
      type(column_type) :: one

      one%name = what
      one%dimension = trim(unit)
      column = [column, one]
   end subroutine add

   !> Some material is plastic or viscous.
   pure logical function model_flows(model)
      type(model_type), intent(in) :: model
      integer :: i

      model_flows = .false.
      do i = 1, size(model%material)
         model_flows = model_flows .or. flows(model%material(i)%flow)
      end do
   end function model_flows

   subroutine history_row(model, frame, row)
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      real(wp), allocatable, intent(out) :: row(:)
      type(pair_summary_type) :: pair
      integer :: i, n

      n = model%mesh%ndim
      row = [real(wp) :: real(frame%step, wp), real(frame%increment, wp), frame%total_time, &
         & real(frame%iterations, wp), real(frame%augmentations, wp)]
      do i = 1, size(model%rigid_body)
         row = [row, reference_values(model%rigid_body(i), n, frame%u), &
            & reference_values(model%rigid_body(i), n, frame%rf)]
      end do
      do i = 1, size(model%pair)
         call summarise_pair(frame%contact(i), pair)
         row = [row, pair%force(:n), pair%area, pair%max_pressure, pair%max_penetration, &
            & real(pair%closed, wp)]
      end do
      row = [row, frame%energy%strain, frame%energy%external, frame%energy%contact, &
         & frame%energy%friction, frame%energy%friction_mean]
      if (model_flows(model)) row = [row, frame%energy%plastic, frame%energy%volume]
      if (allocated(frame%damage)) then
         row = [row, frame%damage%most]
      else
         row = [row, [(0.0_wp, i=1, size(damage_kinds(model)))]]
      end if
      if (is_heated(model)) row = [row, frame%energy%thermal]
      row = [row, frame%energy%artificial, real(frame%certificate%verdict, wp)]
   end subroutine history_row

   !> Translations, then rotations, of a reference node (or of its rotation node).
   pure function reference_values(body, n, values) result(list)
      type(rigid_body_type), intent(in) :: body
      integer, intent(in) :: n               !! dimensions
      real(wp), intent(in) :: values(:, :)   !! (6, nnode)
      real(wp) :: list(3*(n - 1))
      integer :: k, dof

      list = 0.0_wp
      do k = 1, size(list)
         dof = physical_dof(n, k)
         if (k > n .and. body%rotation > 0) then
            list(k) = values(dof - 3, body%rotation)
         else if (body%reference > 0) then
            list(k) = values(dof, body%reference)
         end if
      end do
   end function reference_values

   !> 2D: 1, 2, 6; 3D: 1..6.
   pure integer function physical_dof(n, k)
      integer, intent(in) :: n, k
      physical_dof = k
      if (n == 2 .and. k == 3) physical_dof = 6
   end function physical_dof
end module lopin_recorder_table
