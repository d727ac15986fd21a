!> One *FRICTION card: its words and data lines become a law, or say why they cannot.
!>
!> A single line `mu, value` is CalculiX's stick slope; three or more data, or several lines, are
!> Abaqus' table in slip rate, pressure and temperature.
module lopin_build_friction
   use lopin_kinds, only : wp
   use lopin_error, only : location_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_friction, only : friction_type, law_of, law_number, law_data, regularization_of, &
      & regularization_number, is_regularised, reads_mises
   use lopin_block, only : block_type, field_type, split_fields, field_real, complain, &
      & has_parameter, get_parameter, line_place
   use lopin_build_scene, only : get_word
   implicit none
   private
   public :: read_friction, missing

   integer, parameter :: most = 4                       !! fields of a data line
   real(wp), parameter :: missing = -huge(1.0_wp)       !! a datum that LAW=AUTO was not given

   !> The numbers of the first data line.
   type :: data_type
      integer :: n = 0
      real(wp) :: value(most) = 0.0_wp
      logical :: given(most) = .false.
      type(location_type) :: at(most)
   end type data_type

contains

   subroutine read_friction(friction, block, log)
      type(friction_type), intent(out) :: friction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(data_type) :: data
      character(len=:), allocatable :: word
      type(location_type) :: at
      integer :: errors
      logical :: found

      errors = log%count_of(severity%error)
      friction%at = block%at
      friction%law = law_of%coulomb
      call get_word(block, 'LAW', word, at, found)
      if (found) friction%law = law_number(word)
      call get_word(block, 'REGULARIZATION', word, at, found)
      friction%exact_stick = has_parameter(block, 'LAGRANGE') .or. word == 'NONE'
      if (found .and. word /= 'NONE') friction%regularization = regularization_number(word)
      friction%rough = has_parameter(block, 'ROUGH')
      call positive(block, 'TAUMAX', friction%tau_max, log)
      call positive(block, 'ELASTIC SLIP', friction%elastic_slip, log)
      call positive(block, 'SLIP TOLERANCE', friction%slip_tolerance, log)
      call positive(block, 'V0', friction%v0, log)
      call check_words(friction, block, log)
      call read_data(data, block, log)
      call refuse_table(data, block, log)
      if (log%count_of(severity%error) > errors) return
      if (friction%rough) then
         if (data%n > 0) call log%say(severity%note, 'N0306', 'ROUGH needs no data: there is '// &
            & 'no slip', data%at(1))
         return
      end if
      call take_data(friction, data, block, log)
   end subroutine read_friction

   !> A parameter that is a positive number; left as it is when absent.
   subroutine positive(block, name, value, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: name
      real(wp), intent(inout) :: value
      type(log_type), intent(inout) :: log
      type(field_type) :: field
      real(wp) :: number
      logical :: found

      call get_parameter(block, name, field%text, field%at, found)
      if (.not. found) return
      call field_real(field, number, log, found)
      if (.not. found) return
      value = number
      if (.not. number > 0.0_wp) call complain(log, 'E0321', name//'='//field%text// &
         & ' is not positive', field%at)
   end subroutine positive

   !> Words of *FRICTION that exclude or need each other.
   subroutine check_words(friction, block, log)
      type(friction_type), intent(in) :: friction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=*), parameter :: slips(6) = [character(len=17) :: 'LAW', 'TAUMAX', &
         & 'EXPONENTIAL DECAY', 'ELASTIC SLIP', 'SLIP TOLERANCE', 'V0']
      logical :: smooth
      integer :: i

      smooth = friction%regularization /= regularization_of%linear
      if (friction%rough) then
         do i = 1, size(slips)
            if (has_parameter(block, trim(slips(i)))) call contradict(block, 'ROUGH means no '// &
               & 'slip: it takes no '//trim(slips(i)), log)
         end do
         if (smooth) call contradict(block, 'ROUGH means no slip: it takes no REGULARIZATION', log)
         return
      end if
      if (friction%exact_stick) call refuse_pair(block, 'exact stick (LAGRANGE, '// &
         & 'REGULARIZATION=NONE)', 'ELASTIC SLIP', log)
      if (friction%exact_stick) call refuse_pair(block, 'exact stick (LAGRANGE, '// &
         & 'REGULARIZATION=NONE)', 'SLIP TOLERANCE', log)
      if (has_parameter(block, 'ELASTIC SLIP')) call refuse_pair(block, 'ELASTIC SLIP', &
         & 'SLIP TOLERANCE', log)
      if (smooth) then
         call check_smooth(friction, block, log)
      else if (friction%v0 > 0.0_wp) then
         call contradict(block, 'V0 is the speed of a regularisation, which is not asked for', &
            & log, help='write REGULARIZATION=ARCTAN, TANH or SQRT')
      end if
      if (has_parameter(block, 'EXPONENTIAL DECAY') .and. friction%law /= law_of%coulomb) &
         & call contradict(block, 'EXPONENTIAL DECAY is the decay of mu: it needs LAW=COULOMB', log)
      if (has_parameter(block, 'EQUIVALENT') .and. friction%law /= law_of%tresca &
         & .and. friction%law /= law_of%cristescu) call contradict(block, &
         & 'EQUIVALENT= chooses a stress for LAW=TRESCA', log)
   end subroutine check_words

   !> A law without stick needs one size: a length or, where time matters, a speed.
   subroutine check_smooth(friction, block, log)
      type(friction_type), intent(in) :: friction
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      logical :: slip, rate

      slip = has_parameter(block, 'ELASTIC SLIP')
      rate = has_parameter(block, 'V0')
      if (has_parameter(block, 'LAGRANGE')) call refuse_pair(block, 'a regularised law', &
         & 'LAGRANGE', log)
      if (has_parameter(block, 'SLIP TOLERANCE')) call refuse_pair(block, 'a regularised law', &
         & 'SLIP TOLERANCE', log)
      if (friction%law == law_of%norton_hoff) then
         if (slip .or. .not. rate) call contradict(block, 'a regularised NORTON-HOFF needs V0 '// &
            & 'alone: its traction is a function of the speed', log)
      else if (.not. slip .and. .not. rate) then
         call contradict(block, 'REGULARIZATION needs ELASTIC SLIP or V0', log, &
            & help='ELASTIC SLIP=u0 [length], or V0= [length/time]: at that slip an arctangent '// &
            & 'has half of the shear')
      else if (slip .and. rate) then
         call refuse_pair(block, 'V0', 'ELASTIC SLIP', log)
      end if
   end subroutine check_smooth

   subroutine refuse_pair(block, one, other, log)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: one, other
      type(log_type), intent(inout) :: log

      if (has_parameter(block, other)) call contradict(block, one//' and '//other// &
         & ' exclude each other', log)
   end subroutine refuse_pair

   subroutine contradict(block, message, log, help)
      type(block_type), intent(in) :: block
      character(len=*), intent(in) :: message
      type(log_type), intent(inout) :: log
      character(len=*), intent(in), optional :: help
      call complain(log, 'E0323', message, block%at, help=help)
   end subroutine contradict

   subroutine read_data(data, block, log)
      type(data_type), intent(out) :: data
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      integer :: i

      if (block%nline == 0) return
      call split_fields(block%line(1), field, data%n)
      data%n = min(data%n, most)
      do i = 1, data%n
         data%at(i) = field(i)%at
         call field_real(field(i), data%value(i), log, data%given(i))
      end do
   end subroutine read_data

   !> Several lines are a table of mu; what it varies with is named.
   subroutine refuse_table(data, block, log)
      type(data_type), intent(in) :: data
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      type(field_type), allocatable :: field(:)
      character(len=*), parameter :: column(2:4) = [character(len=11) :: 'slip rate', 'pressure', &
         & 'temperature']
      real(wp) :: value
      integer :: i, j, n
      logical :: found

      do j = 2, block%nline
         call split_fields(block%line(j), field, n)
         do i = 2, min(n, most)
            call field_real(field(i), value, log, found)
            if (.not. found .or. .not. abs(value - data%value(i)) > 0.0_wp) cycle
            call complain(log, 'E0323', 'friction that varies with '//trim(column(i))// &
               & ' is not in this version: several data lines are a table', field(i)%at, &
               & help='EXPONENTIAL DECAY has a law for the slip rate, LAW=COULOMB-OROWAN one '// &
               & 'for the pressure')
            return
         end do
      end do
      if (block%nline > 1) call complain(log, 'E0323', '*FRICTION takes one data line', &
         & line_place(block%line(2)))
   end subroutine refuse_table

   !> From the numbers of the line to the parameters of the law.
   subroutine take_data(friction, data, block, log)
      type(friction_type), intent(inout) :: friction
      type(data_type), intent(in) :: data
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log

      select case (friction%law)
      case (law_of%coulomb)
         if (has_parameter(block, 'EXPONENTIAL DECAY')) then
            call take_decay(friction, data, block, log)
         else
            call take_mu(friction%mu, data, 1, log)
            call read_second(friction, data, log)
            if (.not. data%given(1)) call log%say(severity%warning, 'W0305', '*FRICTION does '// &
               & 'nothing here: it gives no coefficient', block%at, help='write mu on the next '// &
               & 'line')
         end if
         if (.not. max(friction%mu, friction%mu_static) > 0.0_wp) friction%law = law_of%none
      case (law_of%automatic)
         call take_mu(friction%mu, data, 1, log)
         call take_share(friction%m, data, 2, 'the shear factor m', log)
         call take_alpha(friction%alpha, data, 3, log)
         call take_share(friction%q, data, 4, 'the exponent q of NORTON-HOFF', log)
         if (.not. data%given(1)) friction%mu = missing
         if (.not. data%given(2)) friction%m = missing
         if (.not. all(data%given(3:))) friction%alpha = missing
      case default
         call take_listed(friction, data, block, log)
      end select
      if (has_parameter(block, 'EQUIVALENT')) friction%law = law_of%cristescu
   end subroutine take_data

   !> The data of a law as `law_data` lists them. A shear factor that bounds beside TAUMAX, and
   !> comes last, may be left out.
   subroutine take_listed(friction, data, block, log)
      type(friction_type), intent(inout) :: friction
      type(data_type), intent(in) :: data
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=len(law_data)) :: list
      character(len=:), allocatable :: name
      integer :: i, n

      list = law_data(friction%law)
      n = 1 + count([(list(i:i) == ',', i=1, len(list))])
      name = trim(list(index(list, ',', back=.true.) + 1:))
      call need(data, merge(n - 1, n, adjustl(name) == 'm' .and. has_parameter(block, 'TAUMAX') &
         & .and. .not. reads_mises(friction)), trim(list), block, log)
      do i = 1, n
         name = list(:scan(list, ', ') - 1)
         select case (name)
         case ('mu')
            call take_mu(friction%mu, data, i, log)
         case ('m')
            call take_share(friction%m, data, i, 'the shear factor m', log)
            friction%has_m = data%given(i)
         case ('alpha')
            call take_alpha(friction%alpha, data, i, log)
         case ('q')
            call take_share(friction%q, data, i, 'the exponent q of NORTON-HOFF', log)
         end select
         list = adjustl(list(len(name) + 2:))
      end do
   end subroutine take_listed

   !> `mu static, mu kinetic, decay`; without decay the static one holds for ever.
   subroutine take_decay(friction, data, block, log)
      type(friction_type), intent(inout) :: friction
      type(data_type), intent(in) :: data
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log

      call need(data, 3, 'mu static, mu kinetic, decay', block, log)
      call take_mu(friction%mu_static, data, 1, log)
      call take_mu(friction%mu, data, 2, log)
      friction%decay = data%value(3)
      if (friction%decay < 0.0_wp) call complain(log, 'E0321', 'a decay of '// &
         & to_text(friction%decay, 6)//' is negative', data%at(3))
      if (.not. friction%decay > 0.0_wp) friction%mu = friction%mu_static
   end subroutine take_decay

   !> Lecture D prints `1 <= mu <= 0`: the order is the other way round, and 1 is no limit.
   subroutine take_mu(mu, data, i, log)
      real(wp), intent(inout) :: mu
      type(data_type), intent(in) :: data
      integer, intent(in) :: i
      type(log_type), intent(inout) :: log

      if (.not. data%given(i)) return
      mu = data%value(i)
      if (mu < 0.0_wp) call complain(log, 'E0321', 'a friction coefficient is not negative: '// &
         & to_text(mu, 6), data%at(i))
      if (mu > 1.0_wp) call log%say(severity%warning, 'W0321', 'a friction coefficient of '// &
         & to_text(mu, 6)//' is above 1', data%at(i), help='rubber and dry aluminium have '// &
         & 'such; it may also be meant in percent')
   end subroutine take_mu

   subroutine take_alpha(alpha, data, i, log)
      real(wp), intent(inout) :: alpha
      type(data_type), intent(in) :: data
      integer, intent(in) :: i
      type(log_type), intent(inout) :: log

      if (.not. data%given(i)) return
      alpha = data%value(i)
      if (.not. alpha > 0.0_wp) call complain(log, 'E0321', 'alpha = '//to_text(alpha, 6)// &
         & ' of NORTON-HOFF is not positive', data%at(i))
   end subroutine take_alpha

   !> A number from 0 to 1.
   subroutine take_share(share, data, i, what, log)
      real(wp), intent(inout) :: share
      type(data_type), intent(in) :: data
      integer, intent(in) :: i
      character(len=*), intent(in) :: what
      type(log_type), intent(inout) :: log

      if (.not. data%given(i)) return
      share = data%value(i)
      if (share >= 0.0_wp .and. share <= 1.0_wp) return
      call complain(log, 'E0321', what//' = '//to_text(share, 6)//' is outside 0 to 1', data%at(i))
   end subroutine take_share

   subroutine need(data, n, names, block, log)
      type(data_type), intent(in) :: data
      integer, intent(in) :: n
      character(len=*), intent(in) :: names
      type(block_type), intent(in) :: block
      type(log_type), intent(inout) :: log
      character(len=:), allocatable :: word
      type(location_type) :: at
      logical :: found

      if (all(data%given(:n))) return
      call get_word(block, 'LAW', word, at, found)
      if (.not. found) word = 'COULOMB'
      call complain(log, 'E0103', '*FRICTION, LAW='//word//' needs the data '//names, block%at, &
         & help="lopin doc '*FRICTION'")
   end subroutine need

   !> The second datum of a single line: CalculiX's stick slope, unless more follow it.
   subroutine read_second(friction, data, log)
      type(friction_type), intent(inout) :: friction
      type(data_type), intent(in) :: data
      type(log_type), intent(inout) :: log

      if (any(data%given(3:))) then
         call log%say(severity%note, 'N0306', 'the line is read as Abaqus'' mu at one slip '// &
            & 'rate, pressure and temperature: mu = '//to_text(data%value(1), 6)//' everywhere', &
            & data%at(1))
      else if (data%given(2)) then
         if (data%value(2) > 0.0_wp) friction%stick_slope = data%value(2)
         call log%say(severity%note, 'N0306', 'the second datum '//to_text(data%value(2), 6)// &
            & ' is read as CalculiX'' stick slope [stress/length], not as Abaqus'' slip rate', &
            & data%at(2))
         if (data%value(2) < 0.0_wp) call complain(log, 'E0321', 'a stick slope of '// &
            & to_text(data%value(2), 6)//' is negative', data%at(2))
         if (friction%stick_slope > 0.0_wp .and. (is_regularised(friction) &
            & .or. friction%exact_stick)) call log%say(severity%note, 'N0306', 'the stick '// &
            & 'slope is not used: the words of *FRICTION say how it sticks', data%at(2))
      end if
   end subroutine read_second
end module lopin_build_friction
