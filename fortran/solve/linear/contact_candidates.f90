!> Contact candidates of the linear paths: the slave points that get a row, and more where these
!> prove too few.
!>
!> A row costs a column of the compliance. Points much farther apart than anything is prescribed to
!> move, or than two facets where forces act, get none at first. After every solve the gap of every
!> other point is looked at: where one penetrates, it and its neighbours get rows and the increment
!> is solved again, until none does. So the answer is that of all rows.
module lopin_contact_candidates
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_contact_points, only : pair_is_tied
   use lopin_contact_rows, only : contact_rows_type
   use lopin_scene, only : scene_type
   use lopin_present_gaps, only : row_gap_of
   use lopin_row_samples, only : has_samples
   implicit none
   private
   public :: choose_candidates, some_penetrate, add_candidates, add_nearest_candidates, &
      & all_are_candidates, transfer_rows

   !> Scenes with fewer slave points give every point a row at once.
   integer, parameter :: few_points = 300
   !> First reach under forces [facets]; it doubles with each round, and after the last is all.
   real(wp), parameter :: facets = 2.0_wp
   integer, parameter :: last_round = 6

contains

   !> The first reach.
   subroutine choose_candidates(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: moved, near, gap
      integer :: i, pair

      if (scene%points%n <= few_points) return
      call expected_motion(model, moved, near)
      do pair = 1, size(model%pair)
         if (pair_is_tied(model, model%pair(pair)) .or. tool_turns(scene, model, pair)) cycle
         do i = scene%points%first(pair), scene%points%first(pair + 1) - 1
            gap = scene%points%gap(i) + scene%initial%shift(i)
            if (has_samples(scene%points, i)) gap = row_gap_of(scene, model, i)
            scene%accepted%solver%candidate(i) = .not. gap &
               & > penetrates(model, pair) + moved + near*scene%points%size(i)
         end do
      end do
      call keep_whole(scene, model)
   end subroutine choose_candidates

   !> How far things move: the largest prescribed displacement, and some facets if forces act.
   pure subroutine expected_motion(model, moved, near)
      type(model_type), intent(in) :: model
      real(wp), intent(out) :: moved     !! [length]
      real(wp), intent(out) :: near      !! [facets]
      integer :: i, k

      moved = 0.0_wp
      near = 0.0_wp
      do i = 1, size(model%step)
         if (size(model%step(i)%point_load) + size(model%step(i)%face_load) &
            & + size(model%step(i)%body_load) > 0) near = facets
         associate (p => model%step(i)%prescribed)
            do k = 1, size(p)
               if (p(k)%dof <= 3) moved = max(moved, abs(p(k)%value))
               if (p(k)%dof > 3 .and. abs(p(k)%value) > 0.0_wp) near = facets
            end do
         end associate
      end do
      if (.not. moved > 0.0_wp) near = facets
   end subroutine expected_motion

   !> A turning tool moves its far points by more than its reference.
   pure logical function tool_turns(scene, model, pair) result(turns)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      integer :: i

      turns = .false.
      if (scene%points%body(pair) == 0) return
      associate (body => model%rigid_body(scene%points%body(pair)))
         do i = 1, size(model%step)
            associate (p => model%step(i)%prescribed)
               turns = turns .or. any((p%node == body%reference .or. p%node == body%rotation) &
                  & .and. abs(p%value) > 0.0_wp .and. (p%dof > 3 .or. p%node == body%rotation))
            end associate
         end do
      end associate
   end function tool_turns

   !> Gap at which a pair begins to press [length].
   pure real(wp) function penetrates(model, pair)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair

      associate (law => model%interaction(model%pair(pair)%interaction))
         penetrates = max(law%clearance, 0.0_wp) + law%method%first_gap()
      end associate
   end function penetrates

   !> A stiffness that is chosen from the compliance of a pair is that of all its points.
   subroutine keep_whole(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: pair

      do pair = 1, size(model%pair)
         associate (law => model%interaction(model%pair(pair)%interaction), &
            & mine => scene%accepted%solver%candidate( &
            & scene%points%first(pair):scene%points%first(pair + 1) - 1))
            if (.not. law%method%reads_slope()) cycle
            if (.not. law%slope*law%scale > 0.0_wp) mine = any(mine)
         end associate
      end do
   end subroutine keep_whole

   !> A point that has a master, but is not within reach.
   pure logical function is_beyond(scene, i)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: i
      is_beyond = scene%points%facet(i) > 0 .and. .not. scene%accepted%solver%candidate(i)
   end function is_beyond

   pure logical function all_are_candidates(scene)
      type(scene_type), intent(in) :: scene
      all_are_candidates = all(scene%accepted%solver%candidate)
   end function all_are_candidates

   !> Some point beyond the reach would press on its master in the trial state.
   logical function some_penetrate(scene, model)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      some_penetrate = .false.
      do i = 1, scene%points%n
         if (.not. is_beyond(scene, i)) cycle
         some_penetrate = row_gap_of(scene, model, i) < penetrates(model, scene%points%pair(i))
         if (some_penetrate) return
      end do
   end function some_penetrate

   !> More points: those that penetrate in the trial state, and those that nearly do.
   subroutine add_candidates(scene, model, round)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: round             !! 1 the first time in an increment
      integer :: i

      do i = 1, scene%points%n
         if (.not. is_beyond(scene, i)) cycle
         scene%accepted%solver%candidate(i) = round > last_round .or. row_gap_of(scene, model, i) &
            & < penetrates(model, scene%points%pair(i)) + scene%points%size(i)*2.0_wp**(round - 1)
      end do
      call keep_whole(scene, model)
   end subroutine add_candidates

   !> The points within reach do not hold the bodies: the nearest of the others, then all.
   subroutine add_nearest_candidates(scene, model, round)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: round             !! 1 the first time in an increment
      real(wp) :: nearest
      integer :: i

      nearest = huge(1.0_wp)
      do i = 1, scene%points%n
         if (is_beyond(scene, i)) nearest = min(nearest, scene%points%gap(i))
      end do
      do i = 1, scene%points%n
         if (scene%accepted%solver%candidate(i)) cycle
         scene%accepted%solver%candidate(i) = round > 1 .or. (scene%points%facet(i) > 0 &
            & .and. scene%points%gap(i) <= 2.0_wp*nearest + facets*scene%points%size(i))
      end do
      call keep_whole(scene, model)
   end subroutine add_nearest_candidates

   !> What was known of the rows `old` stands in the rows of the scene: states to start from and the
   !> accepted forces of friction. Rows that are new are open and stand where the accepted
   !> displacements put them.
   subroutine transfer_rows(scene, model, old)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(contact_rows_type), intent(in) :: old
      integer :: from(scene%rows%nsolved), row
      real(wp), allocatable :: gap(:)

      call match(old%point(:old%nnormal), scene%rows%point(:scene%rows%nnormal), &
         & from(:scene%rows%nnormal))
      call match(old%point(old%nnormal + 1:old%nsolved), &
         & scene%rows%point(scene%rows%nnormal + 1:scene%rows%nsolved), &
         & from(scene%rows%nnormal + 1:))
      where (from(scene%rows%nnormal + 1:) > 0) from(scene%rows%nnormal + 1:) = &
         & from(scene%rows%nnormal + 1:) + old%nnormal
      allocate (gap(scene%rows%nsolved), source=0.0_wp)
      do row = 1, scene%rows%nnormal
         if (from(row) == 0) gap(row) = max(row_gap_of(scene, model, scene%rows%point(row)), 0.0_wp)
      end do
      associate (answer => scene%answer, kept => scene%accepted%friction, &
         & start => scene%accepted%solver)
         call carry_marks(answer%active, from, old%nsolved)
         call carry_marks(start%active, from, old%nsolved)
         call transfer(start%multiplier, 0.0_wp*gap, from, old%nsolved)
         call transfer(start%force, 0.0_wp*gap, from, old%nsolved)
         call transfer(start%gap, gap, from, old%nsolved)
         call transfer(answer%multiplier, 0.0_wp*gap, from, old%nsolved)
         call transfer(answer%force, 0.0_wp*gap, from, old%nsolved)
         call transfer(answer%gap, gap, from, old%nsolved)
         call transfer(kept%force, 0.0_wp*gap, from, old%nsolved)
         call transfer(kept%gap, gap, from, old%nsolved)
      end associate
      scene%trial%friction = scene%accepted%friction
      scene%trial%solver = scene%accepted%solver
   end subroutine transfer_rows

   !> Marks of the rows that there were; new ones have none.
   pure subroutine carry_marks(mark, from, nold)
      logical, allocatable, intent(inout) :: mark(:)
      integer, intent(in) :: from(:)           !! (nrow) where a row stood; 0: it is new
      integer, intent(in) :: nold              !! rows that there were
      logical :: carried(size(from))
      integer :: i

      if (.not. allocated(mark)) return
      if (size(mark) < nold) return
      carried = .false.
      do i = 1, size(from)
         if (from(i) > 0) carried(i) = mark(from(i))
      end do
      mark = carried
   end subroutine carry_marks

   !> Values of the rows that there were; those of new ones are given.
   pure subroutine transfer(value, new, from, nold)
      real(wp), allocatable, intent(inout) :: value(:)
      real(wp), intent(in) :: new(:)           !! (nrow)
      integer, intent(in) :: from(:)           !! (nrow) where a row stood; 0: it is new
      integer, intent(in) :: nold              !! rows that there were
      real(wp) :: carried(size(from))
      integer :: i

      if (.not. allocated(value)) return
      if (size(value) < nold) return
      carried = new
      do i = 1, size(from)
         if (from(i) > 0) carried(i) = value(from(i))
      end do
      value = carried
   end subroutine transfer

   !> Where each of `new` stands in `old`, both increasing; 0: nowhere.
   pure subroutine match(old, new, from)
      integer, intent(in) :: old(:), new(:)
      integer, intent(out) :: from(:)
      integer :: i, j

      from = 0
      j = 1
      do i = 1, size(new)
         do while (j < size(old))
            if (old(j) >= new(i)) exit
            j = j + 1
         end do
         if (j > size(old)) exit
         if (old(j) /= new(i)) cycle
         from(i) = j
         j = j + 1
      end do
   end subroutine match
end module lopin_contact_candidates
