!> Chords of curved interfaces beside the interference or the gap that they are to carry.
!>
!> Facets that do not match cut an arc at different places: gaps vary by up to the sag s = h t/8 of
!> a facet h long that turns by t. A press fit of the interference d answers with pressures that
!> vary by about s R/(d h) = s/(d t) of themselves: the elements beside the facet give way over h,
!> the ring over R.
module lopin_chord_sag
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type, severity
   use lopin_text, only : to_text
   use lopin_cells, only : cell_type
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_facet_sides, only : facet_sides
   use lopin_surface, only : surface_type
   use lopin_model, only : model_type, surface_of
   use lopin_element_type, only : cells_of_words
   use lopin_mortar_pairs, only : shape_of, is_mortar
   use lopin_contact_points, only : contact_points_type, pair_is_tied
   use lopin_initial_gaps, only : initial_gap_type
   implicit none
   private
   public :: report_chords, chord_sag

   !> Facets that turn more meet at an edge [-]; unevenness that is told, and what finer facets are
   !> to leave.
   real(wp), parameter :: crease = 0.766_wp, told = 0.15_wp
   !> Open gaps: how far they vary beside their mean; interfaces whose gaps vary by more than their
   !> sags are not parallel.
   real(wp), parameter :: varies = 0.5_wp, parallel = 2.0_wp
   !> Of a facet: gaps and sags below are the rounding of positions.
   real(wp), parameter :: rounding = 1.0e-9_wp
   !> Tangential share of contact forces that is told, without friction [-].
   real(wp), parameter :: leaning = 0.01_wp

   !> The chords of the side of a pair that stand off more.
   type :: chords_type
      integer :: surface = 0                   !! index in the model
      real(wp) :: sag = 0.0_wp                 !! largest of a facet [length]
      real(wp) :: turn = 0.0_wp                !! of a facet [rad]
      real(wp) :: off = 0.0_wp                 !! what the gaps vary by chords [length]
      logical :: crossed = .false.             !! gaps vary by more than chords make
   end type chords_type

contains

   !> Warn once for each pair of meshes.
   subroutine report_chords(points, model, initial, log, error)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      type(initial_gap_type), intent(in) :: initial
      type(log_type), intent(inout) :: log
      type(error_type), allocatable, intent(out) :: error
      type(cell_type), allocatable :: cells(:)
      real(wp) :: fit, spread_, floor_, sag(2), turn(2)
      logical :: even
      integer :: pair, side, worst

      ! A run that goes on has been told.
      if (model%start%step > 0) return
      call cells_of_words(model%element_word, cells)
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            if (pair_is_tied(model, p) .or. p%slave == p%master) cycle
            if (any(model%surface([p%slave, p%master])%kind /= surface_of%faces)) cycle
            call measure_fit(points, initial, pair, fit, spread_)
            floor_ = smallest_length(points, model, pair)
            if (.not. (is_mortar(model, p) .or. p%smooth) .and. (p%has_clearance .or. &
               & max(abs(fit), spread_) <= floor_)) then
               call sag_of(model, cells, p%master, sag(1), turn(1), error)
               if (allocated(error)) return
               if (sag(1) > 0.0_wp) call check_chord_angle(points, model, pair, &
                  & turn(1)/sqrt(12.0_wp), log)
            end if
            if (abs(fit) <= floor_) cycle
            even = .not. spread_ > told*abs(fit)*0.05_wp
            if (.not. abs(fit) > 0.0_wp .or. (even .and. .not. is_mortar(model, p))) cycle
            do side = 1, 2
               call sag_of(model, cells, merge(p%slave, p%master, side == 1), sag(side), &
                  & turn(side), error)
               if (allocated(error)) return
            end do
            worst = maxloc(sag, 1)
            if (is_mortar(model, p)) call check_mean_fit(model, pair, fit, sag, log)
            if (even .or. .not. sag(worst) > 0.0_wp) cycle
            call check_chord_fit(model, pair, fit, chords_type(merge(p%slave, p%master, &
               & worst == 1), sag(worst), turn(worst), min(spread_, sum(sag)), &
               & spread_ > parallel*sum(sag)), log)
         end associate
      end do
   end subroutine report_chords

   !> What the rounding of positions makes of gaps.
   pure real(wp) function smallest_length(points, model, pair) result(length)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      associate (of => points%first(pair), to => points%first(pair + 1) - 1)
         length = rounding*maxval([0.0_wp, points%size(of:to)]) &
            & + 16.0_wp*epsilon(1.0_wp)*maxval(abs(model%mesh%x))
      end associate
   end function smallest_length

   !> *CLEARANCE or matching facets even the gaps, but nodes still press along the normals of
   !> single facets: their forces lean against the normals of the slave.
   subroutine check_chord_angle(points, model, pair, half, log)
      type(contact_points_type), intent(in) :: points
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: half             !! of nodes that slide along the chords [-]
      type(log_type), intent(inout) :: log
      real(wp) :: lean, most, bound, all
      integer :: i

      lean = 0.0_wp
      all = 0.0_wp
      do i = points%first(pair), points%first(pair + 1) - 1
         associate (side => points%side(:, i), normal => points%normal(:, i))
            if (points%facet(i) == 0 .or. .not. dot_product(side, normal) < -crease) cycle
            lean = lean + points%weight(i)*norm2(side + normal)**2
            all = all + points%weight(i)
         end associate
      end do
      if (.not. all > 0.0_wp) return
      lean = sqrt(lean/all)
      associate (p => model%pair(pair))
         bound = leaning
         if (moves(model)) lean = max(lean, half)
         most = model%interaction(p%interaction)%friction%mu
         if (most > 0.0_wp) bound = min(bound, told*most)
         if (.not. lean > bound) return
         call log%say(severity%warning, 'W0341', 'the facets of '// &
            & model%surface(p%master)%name//' lean by '//to_text(lean, 2)//' against those of '// &
            & model%surface(p%slave)%name//': tangential forces of '//pair_name(model, pair)// &
            & ' may be wrong by this share of the normal ones', p%at, help= &
            & 'TYPE=SURFACE TO SURFACE, SMOOTH=YES, facets that match or finer ones')
      end associate
   end subroutine check_chord_angle

   !> Nodes are followed along the chords: the paths of the present shape.
   pure logical function moves(model)
      type(model_type), intent(in) :: model
      integer :: i

      moves = any(model%step%nlgeom) .or. model%path == 'FINITE'
      do i = 1, size(model%step)
         if (.not. allocated(model%step(i)%temperature)) cycle
         moves = moves .or. size(model%step(i)%temperature) > 0
      end do
   end function moves

   !> Mean interference (positive) or mean gap (negative) of a pair, and how far its gaps vary.
   pure subroutine measure_fit(points, initial, pair, fit, spread)
      type(contact_points_type), intent(in) :: points
      type(initial_gap_type), intent(in) :: initial
      integer, intent(in) :: pair
      real(wp), intent(out) :: fit, spread     !! [length]
      real(wp) :: low, high, gap, bite
      integer :: i, n, pressed

      fit = 0.0_wp
      bite = 0.0_wp
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      n = 0
      pressed = 0
      do i = points%first(pair), points%first(pair + 1) - 1
         if (points%facet(i) == 0) cycle
         gap = points%gap(i) + initial%shift(i)
         n = n + 1
         fit = fit - gap
         low = min(low, gap)
         high = max(high, gap)
         if (.not. initial%overclosure(i) > 0.0_wp) cycle
         pressed = pressed + 1
         bite = bite + initial%overclosure(i)
      end do
      spread = 0.0_wp
      if (n == 0) return
      spread = high - low
      fit = fit/real(n, wp)
      if (pressed > 0) fit = bite/real(pressed, wp)
   end subroutine measure_fit

   subroutine check_chord_fit(model, pair, fit, chords, log)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: fit              !! of measure_fit [length]
      type(chords_type), intent(in) :: chords
      type(log_type), intent(inout) :: log
      real(wp) :: uneven
      character(len=:), allocatable :: text

      associate (p => model%pair(pair))
         text = 'the chords of '//model%surface(chords%surface)%name//' stand up to '// &
            & to_text(chords%sag, 3)//' off their arc, beside '
         if (fit > 0.0_wp) then
            uneven = chords%off/(fit*chords%turn)
            if (.not. uneven > told) return
            call log%say(severity%warning, 'W0341', text//'an interference of '//to_text(fit, 3)// &
               & ': pressures of '//pair_name(model, pair)//' may be uneven by '// &
               & to_text(100.0_wp*uneven, 2)//' %', p%at, help= &
               & to_text(ceiling(uneven/told))//' times as many facets along the curve, '// &
               & 'facets that match, or second-order elements on both sides')
         else if (chords%off > -varies*fit .and. .not. chords%crossed) then
            call log%say(severity%warning, 'W0341', text//'a gap of '//to_text(-fit, 3)// &
               & ': '//pair_name(model, pair)//' will close at the corners of its facets first', &
               & p%at, help=to_text(ceiling(sqrt(chords%off/(-fit*told))))//' times as many '// &
               & 'facets along the curve, facets that match, second-order elements on both '// &
               & 'sides, or *CLEARANCE')
         end if
      end associate
   end subroutine check_chord_fit

   !> Surface to surface a fit is a mean, even where chords are long: those of the shaft lie inside
   !> its arc by two thirds of their sags, those of the bore too, and the difference is missing.
   subroutine check_mean_fit(model, pair, fit, sag, log)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: fit              !! mean interference [length]
      real(wp), intent(in) :: sag(2)           !! of the slave and of the master [length]
      type(log_type), intent(inout) :: log
      real(wp) :: missing

      missing = 2.0_wp/3.0_wp*abs(sag(1) - sag(2))
      if (.not. (fit > 0.0_wp .and. missing > 0.5_wp*told*fit)) return
      associate (p => model%pair(pair))
         call log%say(severity%warning, 'W0341', 'the chords of '//model%surface(merge(p%slave, &
            & p%master, sag(1) > sag(2)))%name//' stand up to '//to_text(maxval(sag), 3)// &
            & ' off their arc: the mean interference of '//pair_name(model, pair)//' is '// &
            & to_text(fit, 3)//' where that of the arcs differs by about '// &
            & to_text(missing, 2)//', and pressures may be off by '// &
            & to_text(100.0_wp*missing/fit, 2)//' %', p%at, help= &
            & 'as many facets on both sides, '// &
            & to_text(ceiling(sqrt(missing/(0.5_wp*told*fit))))// &
            & ' times as many on this one, or second-order elements on both')
      end associate
   end subroutine check_mean_fit

   pure function pair_name(model, pair) result(name)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      character(len=:), allocatable :: name
      name = '('//model%surface(model%pair(pair)%slave)%name//', '// &
         & model%surface(model%pair(pair)%master)%name//')'
   end function pair_name

   subroutine sag_of(model, cells, number, sag, turn, error)
      type(model_type), intent(in) :: model
      type(cell_type), intent(in) :: cells(:)
      integer, intent(in) :: number            !! of the surface
      real(wp), intent(out) :: sag, turn
      type(error_type), allocatable, intent(out) :: error
      type(surface_type) :: surface
      type(facet_rule_type) :: rules(6)

      sag = 0.0_wp
      turn = 0.0_wp
      call shape_of(surface, model, cells, number, error)
      if (allocated(error)) return
      call new_facet_rules(rules)
      call chord_sag(surface, rules, model%mesh%x, sag, turn)
   end subroutine sag_of

   !> Largest sag of the facets that meet smoothly, and how far these turn.
   pure subroutine chord_sag(surface, rules, x, sag, turn)
      type(surface_type), intent(in) :: surface
      type(facet_rule_type), intent(in) :: rules(:)
      real(wp), intent(in) :: x(:, :)          !! (ndim, nnode) [length]
      real(wp), intent(out) :: sag             !! [length]
      real(wp), intent(out) :: turn            !! [rad]
      real(wp) :: side(size(x, 1), 8), first(size(x, 1), surface%nnode), cosine, angle
      logical :: met(surface%nnode)
      integer :: i, j, n

      sag = 0.0_wp
      turn = 0.0_wp
      met = .false.
      do i = 1, surface%facets%n
         n = surface%facets%nnode(i)
         call facet_sides(rules(surface%facets%cell(i))%cell, x(:, surface%facets%node(:n, i)), &
            & side(:, :n))
         do j = 1, n
            associate (at => surface%local(j, i))
               side(:, j) = side(:, j)/norm2(side(:, j))
               if (.not. met(at)) then
                  met(at) = .true.
                  first(:, at) = side(:, j)
                  cycle
               end if
               cosine = dot_product(first(:, at), side(:, j))
               if (cosine < crease) cycle
               angle = 2.0_wp*asin(min(1.0_wp, 0.5_wp*norm2(first(:, at) - side(:, j))))
               if (.not. surface%size(i)*angle/8.0_wp > max(sag, rounding*surface%size(i))) cycle
               sag = surface%size(i)*angle/8.0_wp
               turn = angle
            end associate
         end do
      end do
   end subroutine chord_sag
end module lopin_chord_sag
