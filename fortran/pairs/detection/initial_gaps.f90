!> Gaps at the start: ADJUST, CLEARANCE and the frozen rule for overclosures, never applied
!> silently.
module lopin_initial_gaps
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise, log_type, severity
   use lopin_plural, only : plural
   use lopin_text, only : to_text
   use lopin_row_samples, only : sample_type, base_samples, row_value
   use lopin_model, only : model_type, initial_of
   use lopin_contact_points, only : contact_points_type, pair_is_tied
   implicit none
   private
   public :: initial_gap_type, new_initial_gaps, may_tie, is_moved

   !> Overclosures below this share of a facet are inexact geometry, not interference (frozen).
   real(wp), parameter :: inexact = 1.0e-3_wp
   !> Deeper overclosures, in facets, are mistakes.
   real(wp), parameter :: too_deep = 0.5_wp
   !> Gaps below this share of a facet are the rounding of coordinates: nothing is said of them.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> Digits of lengths in messages.
   integer, parameter :: shown = 5

   type :: initial_gap_type
      real(wp), allocatable :: shift(:)   !! (npoint) added to the geometric gap: ADJUST, CLEARANCE
                                          !! [length]
      real(wp), allocatable :: overclosure(:)   !! (npoint) >= 0, ramped in over the first step
                                                !! [length]
      real(wp), allocatable :: early(:)         !! (npoint) >= 0, the same of rows of mid-side nodes
                                                !! whose mean gap is negative where no node's is
      logical, allocatable :: touches(:)       !! (npoint) closed at the start
   end type initial_gap_type

   !> What messages say of a pair.
   type :: tally_type
      integer :: adjusted = 0                  !! points set on the master
      real(wp) :: moved = 0.0_wp               !! the farthest of them by [length]
      integer :: farthest = 0                  !! point, beside its facet
      real(wp) :: far = 0.0_wp                 !! in facets [-]
      integer :: untied = 0                    !! of a tied pair
      integer :: interfering = 0               !! points inside the master
      integer :: worst = 0                     !! the deepest, beside its facet
      real(wp) :: deepest = 0.0_wp             !! in facets [-]
   end type tally_type

contains

   !> ADJUST, CLEARANCE and the rule for overclosures of every pair.
   subroutine new_initial_gaps(self, model, points, log, error)
      type(initial_gap_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      integer :: pair

      allocate (self%shift(points%n), self%overclosure(points%n), self%early(points%n), &
         & source=0.0_wp)
      allocate (self%touches(points%n), source=.false.)
      ! A run that goes on has its gaps already.
      if (model%start%step > 0) return
      do pair = 1, size(model%pair)
         call check_pair(self, model, points, pair, log, error)
         if (allocated(error)) return
         if (.not. pair_is_tied(model, model%pair(pair))) call find_early(self, model, points, pair)
      end do
   end subroutine new_initial_gaps

   !> Mean gaps of rows that are closed, with those of the nodes: opposite a curved tool a mid-side
   !> node that touches or nearly so has ends that stand off.
   subroutine find_early(self, model, points, pair)
      type(initial_gap_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair
      type(sample_type), allocatable :: sample(:)
      integer :: i

      do i = points%first(pair), points%first(pair + 1) - 1
         if (points%facet(i) == 0 .or. .not. points%share(i) > 0.0_wp) cycle
         call base_samples(points, i, model%mesh%x, sample)
         self%early(i) = max(0.0_wp, -dot_product(sample%c, sample%gap) &
            & - row_value(points, sample, self%shift + self%overclosure))
         if (self%early(i) <= inexact*points%size(i)) self%early(i) = 0.0_wp
      end do
   end subroutine find_early

   !> The gaps of a pair at the start, and what is said of them.
   subroutine check_pair(self, model, points, pair, log, error)
      type(initial_gap_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(tally_type) :: tally
      integer :: i
      real(wp) :: gap
      logical :: adjust, keeps, meant

      associate (p => model%pair(pair))
         keeps = model%interaction(p%interaction)%no_separation
         meant = p%control%initial == initial_of%interference .or. nothing_acts(model)
         do i = points%first(pair), points%first(pair + 1) - 1
            if (pair_is_tied(model, p)) then
               if (.not. may_tie(points, i, p%adjust)) tally%untied = tally%untied + 1
               cycle
            end if
            if (points%facet(i) == 0) cycle
            gap = points%gap(i) + points%above(i)
            if (p%has_clearance) then
               self%shift(i) = p%clearance - gap
               gap = p%clearance
            end if
            adjust = gap < 0.0_wp .and. gap > -merge(rounding, inexact, meant)*points%size(i)
            ! What never separates is not pulled together by inexact geometry either.
            if (keeps) adjust = adjust .or. abs(gap) < inexact*points%size(i)
            if (p%adjust >= 0.0_wp) adjust = adjust .or. gap <= p%adjust
            if (allocated(p%adjust_node)) adjust = adjust .or. any(p%adjust_node == points%node(i))
            if (p%control%initial == initial_of%adjust) adjust = adjust .or. gap < 0.0_wp
            if (adjust .and. .not. p%has_clearance) then
               call note_move(tally, i, abs(gap), points%size(i))
               self%shift(i) = self%shift(i) - points%gap(i)
               gap = 0.0_wp
            end if
            self%touches(i) = gap <= inexact*points%size(i)
            if (gap >= 0.0_wp) cycle
            self%overclosure(i) = -gap
            tally%interfering = tally%interfering + 1
            if (-gap/points%size(i) <= tally%deepest) cycle
            tally%deepest = -gap/points%size(i)
            tally%worst = i
         end do
      end associate
      call say_moves(tally, model, points, pair, log)
      if (tally%interfering > 0) call report_overclosure(model, points, pair, tally%interfering, &
         & tally%worst, tally%deepest, log, error)
   end subroutine check_pair

   !> A point that is set on the master.
   pure subroutine note_move(tally, point, distance, size)
      type(tally_type), intent(inout) :: tally
      integer, intent(in) :: point
      real(wp), intent(in) :: distance, size   !! size: of the facets there [length]

      if (distance > rounding*size) tally%adjusted = tally%adjusted + 1
      tally%moved = max(tally%moved, distance)
      if (distance <= tally%far*size) return
      tally%far = distance/size
      tally%farthest = point
   end subroutine note_move

   !> What ADJUST moved, and what is not tied.
   subroutine say_moves(tally, model, points, pair, log)
      type(tally_type), intent(in) :: tally
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair
      type(log_type), intent(inout) :: log

      associate (p => model%pair(pair), far => tally%far, farthest => tally%farthest)
         if (tally%adjusted > 0) call log%say(severity%note, 'N0316', to_text(tally%adjusted)// &
            & ' slave points of '// &
            & model%surface(p%slave)%name//' were set on '//model%surface(p%master)%name// &
            & ' without strain, by at most '//to_text(tally%moved, shown), p%at)
         if (far > too_deep) call log%say(severity%warning, 'W0316', 'ADJUST sets slave points '// &
            & 'of '//model%surface(p%slave)%name//' on '//model%surface(p%master)%name// &
            & ' over more than half a facet: node '//to_text(model%mesh%node_label( &
            & points%node(farthest)))//' by '//to_text(far*points%size(farthest), shown)//' ('// &
            & to_text(nint(100.0_wp*far))//' % of a facet)', p%at, help='move the bodies '// &
            & 'together in the mesh; ADJUST is for gaps that the mesh makes')
         if (tally%untied > 0) call log%say(severity%warning, 'W0318', to_text(tally%untied)// &
            & ' of '// &
            & to_text(points%first(pair + 1) - points%first(pair))//' slave nodes of '// &
            & model%surface(p%slave)%name// &
            & ' are not tied: they are farther than half a facet from '// &
            & model%surface(p%master)%name, p%at, &
            & help='ADJUST= on *CONTACT PAIR ties what is nearer than its value')
      end associate
   end subroutine say_moves

   !> No load, no motion, no heat in the whole deck: what overlaps is all that it can be about.
   pure logical function nothing_acts(model) result(none)
      type(model_type), intent(in) :: model
      integer :: s

      none = .false.
      if (.not. allocated(model%step)) return
      none = .true.
      do s = 1, size(model%step)
         associate (step => model%step(s))
            if (allocated(step%point_load)) none = none .and. size(step%point_load) == 0
            if (allocated(step%face_load)) none = none .and. size(step%face_load) == 0
            if (allocated(step%body_load)) none = none .and. size(step%body_load) == 0
            if (allocated(step%temperature)) none = none .and. size(step%temperature) == 0
            if (allocated(step%prescribed)) none = none &
               & .and. .not. any(abs(step%prescribed%value) > 0.0_wp)
         end associate
      end do
      if (allocated(model%initial_stress)) none = none .and. size(model%initial_stress) == 0
      if (allocated(model%initial_state)) none = none .and. size(model%initial_state) == 0
   end function nothing_acts

   !> ADJUST moved a point, over more than inexact geometry: its gaps are those of no mesh.
   elemental logical function is_moved(shift, size)
      real(wp), intent(in) :: shift, size      !! size: of the facets there [length]
      is_moved = abs(shift) > inexact*size
   end function is_moved

   !> A point of a tied pair that has a master near enough.
   pure logical function may_tie(points, i, adjust)
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: i
      real(wp), intent(in) :: adjust           !! ADJUST= [length]
      may_tie = points%facet(i) > 0 .and. abs(points%gap(i)) <= max(too_deep*points%size(i), adjust)
   end function may_tie

   subroutine report_overclosure(model, points, pair, number, worst, deepest, log, error)
      type(model_type), intent(in) :: model
      type(contact_points_type), intent(in) :: points
      integer, intent(in) :: pair, number, worst
      real(wp), intent(in) :: deepest
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text, help, note

      associate (p => model%pair(pair))
         text = plural(number, 'slave point')//' of '//model%surface(p%slave)%name// &
            & trim(merge(' penetrates', ' penetrate ', number == 1))//' '// &
            & model%surface(p%master)%name//' at the start, the deepest, node '// &
            & to_text(model%mesh%node_label(points%node(worst)))//', by '// &
            & to_text(deepest*points%size(worst), shown)//' ('// &
            & to_text(100.0_wp*deepest, 2)//' % of a facet)'
         help = 'ADJUST=YES on *CONTACT PAIR moves them out without strain; a tool with its '// &
            & 'outward side away from the slave shows like this too'
         if (deepest > too_deep .or. p%control%initial == initial_of%error) then
            note = 'INITIAL=ERROR asks to refuse it'
            if (deepest > too_deep) then
               note = 'deeper than half a facet is a mistake of position, unit or side'
               help = 'the outward side of '//model%surface(p%master)%name//' is the one that '// &
                  & 'faces '//model%surface(p%slave)%name//' (a profile has it on the left of '// &
                  & 'the way); move them apart, or leave faces that look elsewhere out of the slave'
            end if
            call raise(error, error_code%deck, 'E0311', text, p%at, help=help, note=note)
         else if (p%control%initial == initial_of%interference .or. p%has_clearance) then
            call log%say(severity%note, 'N0311', text// &
               & ': an interference as meant, resolved in the first step', &
               & p%at)
         else
            call log%say(severity%warning, 'W0311', text// &
               & ': treated as interference, resolved in the first step', &
               & p%at, help=help//'; *CONTACT CONTROLS, INITIAL=INTERFERENCE says that it is meant')
         end if
      end associate
   end subroutine report_overclosure
end module lopin_initial_gaps
